//! Checkpoints of ensembles and loops.

use libration::State;
use libration::checkpoint::{Checkpoint, CheckpointError};
use libration::control::clock::{Correlated, Drifting, Gaussian, Jittered};
use libration::control::controller::StateFeedback;
use libration::control::{Feedback, Jitter, Latency, Schedule};
use libration::ensemble::{All, Ensemble, Execution, Loops, Setup};
use libration::integrator::VelocityVerlet;
use libration::system::{BaselineOnly, HenonHeiles, Oscillator};

use super::{executions, refused};

#[test]
fn an_ensemble_goes_on_bit_for_bit_wherever_it_is_taken_up() {
    let system = All(BaselineOnly(HenonHeiles { lambda: 1.0 }));
    let start = |n: usize| State { q: [0.001 * n as f64, 0.1], v: [0.0, 0.05] };
    let make = |execution| Ensemble::<f64, 2>::from_fn(333, execution, start).unwrap();
    let mut whole = make(Execution::serial());
    whole.advance(VelocityVerlet, system, All(0.01), 77).unwrap();
    let state = whole.to_bytes();
    whole.advance(VelocityVerlet, system, All(0.01), 100).unwrap();
    for execution in executions() {
        let mut other = make(execution);
        other.restore(&state).unwrap();
        assert!(other.step() == 77 && other.to_bytes() == state);
        other.advance(VelocityVerlet, system, All(0.01), 100).unwrap();
        assert!(other.to_bytes() == whole.to_bytes());
    }
    let fewer = Ensemble::<f64, 2>::from_fn(332, Execution::serial(), start).unwrap();
    assert!(refused(&fewer, &whole).contains("trajectories is 332; it must be 333"));
    let short = whole.restore(&state[..100]).unwrap_err();
    assert_eq!(short, CheckpointError::Length { found: 100, wanted: state.len() });
}

#[test]
fn loops_go_on_bit_for_bit_with_all_that_they_remember() {
    let gains = Feedback { position: 10.0, velocity: 2.0 };
    let clock = (Jittered(Gaussian(0.1)), Correlated { rms: 0.1, correlation: 0.9 });
    let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 10.0 })), VelocityVerlet)
        .controller(StateFeedback::to_origin(gains))
        .clock((clock, Drifting(Jitter::Gaussian(1e-4))))
        .delay(Schedule::late(Latency::of_steps(2.5).unwrap()));
    let starts = [State { q: [1.0_f64], v: [0.0] }; 100];
    let make = |seed, execution| Loops::new(setup, 0.01, seed, [0.0], &starts, execution).unwrap();
    let mut whole = make(7, Execution::serial());
    whole.advance(300).unwrap();
    let state = whole.to_bytes();
    whole.advance(300).unwrap();
    for execution in executions() {
        let mut other = make(7, execution);
        other.restore(&state).unwrap();
        assert!(other.step() == 300 && other.to_bytes() == state);
        other.advance(300).unwrap();
        assert!(other.to_bytes() == whole.to_bytes());
    }
    let seeded = make(8, Execution::serial());
    assert!(refused(&seeded, &whole).contains("its seed is 8; it must be 7"));
}
