//! Environments whose transitions are kept.

use libration::ensemble::All;
use libration::integrator::SymplecticEuler;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::{Environment, World};
use libration::system::{BaselineOnly, Oscillator};

/// A spring, compiled once for all tests and on one instruction set.
pub(crate) fn world(dt: f64, bound: f64, start: UniformStart<1>) -> impl World<f32, 2, 1> {
    let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.0, bound };
    let spring = All(BaselineOnly(Oscillator { omega2: 10.0_f32 }));
    Environment::new(spring, SymplecticEuler, dt, task, start).limit(11)
}
