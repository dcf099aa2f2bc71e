//! Exact steps of linear systems.

use libration::analysis::ZohStep;
use libration::integrator::Exact;
use libration::number::Wide;
use libration::system::{CommandedSystem, DampedOscillator, HenonHeiles, Oscillator};
use libration::{Integrator, Model, Scalar, State};

/// Radians by which a part of an exact step turns at most.
const PART: f64 = 0.5;

/// Of a step under a command, against the exponential of its matrix in 1024 bits.
fn error(model: impl Model<1>, dt: f64) -> f64 {
    let exact = ZohStep::exact(model, &State::origin(), Wide::from_f64(dt));
    let (start, command) = (State { q: [0.7], v: [-1.3] }, 2.5);
    let held = CommandedSystem { system: model.on::<f64>(), command: [command] };
    let found = Exact::new(model, dt).unwrap().step(&held, start, dt);
    let moved = exact.phi.apply(&start.map(Wide::from_f64));
    let wanted = moved.plus(Wide::from_f64(command), exact.gamma).map(|x| x.to_f64());
    let size = wanted.coordinates().fold(0.0, |size: f64, x| size.max(x.abs()));
    let off = found.coordinates().zip(wanted.coordinates()).map(|(a, b)| (a - b).abs());
    off.fold(0.0, f64::max) / size
}

#[test]
fn a_step_under_a_command_is_that_of_the_matrix_exponential() {
    for dt in [1e-6, 1e-3, 0.1, 0.4, 3.0, 50.0] {
        for omega2 in [0.0_f64, 1e-4, 10.0, 400.0] {
            // Each part rounds by a few units, all of them to one side at worst.
            let parts = 1.0 + 2.0 * dt * omega2.sqrt() / PART;
            let bound = 8.0 * f64::EPSILON * parts;
            let oscillator = error(Oscillator { omega2 }, dt);
            assert!(oscillator < bound, "ω² = {omega2}, Δt = {dt}: {oscillator:e}");
            if omega2 * dt <= 100.0 {
                let damped = error(DampedOscillator { omega2, gamma: 0.3 }, dt);
                assert!(damped < bound, "damped, ω² = {omega2}, Δt = {dt}: {damped:e}");
            }
        }
    }
}

#[test]
fn a_step_five_times_as_long_as_foreseen_is_still_exact() {
    let (model, dt) = (Oscillator { omega2: 10.0 }, 0.1);
    let start = State { q: [1.0], v: [0.0] };
    let step = Exact::new::<1>(model, dt).unwrap().step(&model, start, 5.0 * dt);
    let turn = 10.0_f64.sqrt() * 5.0 * dt;
    assert!((step.q[0] - turn.cos()).abs() < 4.0 * f64::EPSILON);
}

#[test]
fn a_nonlinear_system_and_a_step_that_is_far_too_long_have_none() {
    assert_eq!(Exact::new::<2>(HenonHeiles { lambda: 1.0 }, 0.1), None);
    assert_eq!(Exact::new::<1>(Oscillator { omega2: 1.0 }, 4e4), None);
}
