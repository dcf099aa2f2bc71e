//! A system with all functions in an ensemble.

use libration::ensemble::{All, BatchFloat, Ensemble, Execution, InstructionSet};
use libration::integrator::VelocityVerlet;
use libration::{Elementary, Integrator, State, System};

/// A spring that hardens, between soft walls, with saturated damping and a motor with a dead band.
#[derive(Clone, Copy)]
struct Mechanism;

impl<S: Elementary> System<S, 1> for Mechanism {
    fn acceleration(&self, state: &State<S, 1>) -> [S; 1] {
        let ([q], [v]) = (state.q, state.v);
        let c = S::from_f64;
        let spring = -q.sinh() - q.tan() * c(0.01);
        let wall = (q * c(3.0)).cosh().ln() * q.signum() * c(0.1);
        let damping = -(v * c(5.0)).tanh() * c(0.02);
        let motor = v.abs().select_less_equal(c(0.1), c(0.0), v.atan2(q) * c(0.05));
        let bounded = q.max(c(-0.9)).min(c(0.9));
        let joint = (bounded.asin() - bounded.acos()) * c(0.02) + v.atan() * c(0.01);
        [spring - wall + damping + motor + joint - (-v * v).exp() * c(0.03)]
    }
}

fn lanes_are_lone_trajectories<T: BatchFloat>() {
    let start = |n: usize| State {
        q: [T::from_f64(0.015 * n as f64 - 1.4)],
        v: [T::from_f64(0.8 - 0.01 * n as f64)],
    };
    let dt = T::from_f64(0.01);
    for set in InstructionSet::available() {
        let execution = Execution::serial().instructions(set).unwrap().threads(2).unwrap().worth(1);
        let mut all = Ensemble::from_fn(187, execution, start).unwrap();
        all.advance(VelocityVerlet, All(Mechanism), All(dt), 300).unwrap();
        for n in 0..187 {
            let lone = (0..300).fold(start(n), |s, _| VelocityVerlet.step(&Mechanism, s, dt));
            assert!(lone.coordinates().all(|x| x.is_finite()), "{n}: {lone:?}");
            assert_eq!(all.state(n), Some(lone), "{n}");
        }
    }
}

#[test]
fn a_lane_of_a_system_with_all_functions_is_the_lone_trajectory() {
    lanes_are_lone_trajectories::<f64>();
    lanes_are_lone_trajectories::<f32>();
}
