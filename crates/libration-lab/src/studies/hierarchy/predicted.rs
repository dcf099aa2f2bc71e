//! How far trajectories must come apart.

use libration::State;
use libration::analysis::{Feedback, Jitter, Latency, Plant};
use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;

use super::imperfection::{Kind, Profile};
use super::trial::{COUNT, DT, SPRING};

const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// The rms distance from the undisturbed orbits in units of their size, after `n` steps; none where rounding decides.
pub(super) fn divergence(kind: Kind, profile: &Profile, n: u64) -> Option<f64> {
    let n = n as f64;
    let apart = |angle_squared: f64| (-2.0 * (-angle_squared / 2.0).exp_m1()).sqrt();
    match kind {
        Kind::Latency => Some((growth(profile.latency)? * n).exp_m1()),
        Kind::Jitter => Some(apart(n * turned(profile.jitter)?.powi(2))),
        Kind::Asynchrony => Some(apart((n * turned(profile.asynchrony)?).powi(2))),
        Kind::Precision => None,
    }
}

/// How far the two may lie apart, as a part of the prediction, and why.
pub(super) fn tolerance(kind: Kind, profile: &Profile) -> (f64, &'static str) {
    let z = SPRING.omega2.sqrt() * DT;
    match kind {
        Kind::Latency => (
            0.02 + 2.0 * z * (1.0 + profile.latency),
            "an orbit that begins without a past lies off the growing one by the angle of the latency",
        ),
        _ => (
            4.0 / (2.0 * COUNT as f64).sqrt() + z,
            "four standard errors of a root mean square over the trajectories, and the angle of a step",
        ),
    }
}

/// The growth of the orbit in a step where the force is so many steps late: the spring as a feedback of what moves
/// freely without it.
fn growth(steps: f64) -> Option<f64> {
    let free = Plant::new(SymplecticEuler, Oscillator { omega2: 0.0 }, ORIGIN, DT);
    let spring = Feedback { position: SPRING.omega2, velocity: 0.0 };
    Some(free.spectral_radius(spring, Latency::of_steps(steps)?).to_f64().ln())
}

/// The rms angle by which a relative change of this rms in the length of a step turns a trajectory.
fn turned(rms: f64) -> Option<f64> {
    let plant = Plant::new(SymplecticEuler, SPRING, ORIGIN, DT);
    // The mean over a Gaussian law has fallen to 1/e where the angle is √2.
    Some(2.0_f64.sqrt() / plant.dephasing_steps(Jitter::Gaussian(rms))?.to_f64())
}
