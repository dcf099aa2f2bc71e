//! One trajectory by the machine beside the compiled simulator.

use libration::equations::Dynamics;
use libration::integrator::Exact;
use libration::simulation::{SimulationError, Simulator};
use libration::system::{Kepler, Oscillator, Pendulum};
use libration::{AnyMethod, Float, Method, Model, State, Trajectory};

fn bits<S: Float>(state: &[S]) -> Vec<u64> {
    state.iter().map(|x| x.to_f64().to_bits()).collect()
}

/// Asserts that both end alike: after all steps, or before one whose state is not finite.
fn check<S: Float, M: Model<D>, const D: usize>(
    method: Method,
    model: M,
    start: State<f64, D>,
    dt: f64,
    steps: u64,
) -> bool {
    let (start, dt) = (start.map(S::from_f64), S::from_f64(dt));
    let mut simulator = Simulator::new(model.on::<S>(), method, start, dt).expect("a valid start");
    let end = simulator.run(steps, &mut ());
    let dynamics = Dynamics::of::<D>(&model, None);
    let first: Vec<S> = start.coordinates().collect();
    let mut own = Trajectory::new(AnyMethod::from(method), &dynamics, &first, dt);
    // In two pieces, since the second begins with what the first carries.
    let is_finite = own.advance(steps / 3) && own.advance(steps - steps / 3);
    let sample = simulator.sample();
    let wanted: Vec<S> = sample.state.coordinates().collect();
    let name = format!("{} in {}", method.name(), S::NAME);
    assert_eq!(bits(own.state()), bits(&wanted), "{name}");
    assert_eq!((own.steps(), own.time()), (sample.step, sample.time), "{name}");
    match end {
        Ok(()) => assert!(is_finite, "{name}"),
        Err(SimulationError::NotFinite { step, time }) => {
            assert!(!is_finite && (own.steps() + 1, own.time_of(step)) == (step, time), "{name}");
        }
        Err(error) => panic!("{error}"),
    }
    is_finite
}

#[test]
fn a_trajectory_has_the_bits_of_the_compiled_simulator_in_every_method_and_float_type() {
    for method in Method::ALL {
        let pendulum = Pendulum { omega2: 9.81 };
        let start = State { q: [1.1], v: [0.3] };
        check::<f64, _, 1>(method, pendulum, start, 0.01, 100);
        check::<f32, _, 1>(method, pendulum, start, 0.01, 100);
        check::<half::f16, _, 1>(method, pendulum, start, 0.01, 100);
        check::<half::bf16, _, 1>(method, pendulum, start, 0.01, 100);
        let orbit = State { q: [1.0, 0.0], v: [0.0, 1.2] };
        check::<f64, _, 2>(method, Kepler { mu: 1.0 }, orbit, 0.01, 100);
    }
}

#[test]
fn a_trajectory_stays_before_the_step_that_is_not_finite() {
    let start = State { q: [1.0], v: [0.0] };
    for method in [Method::ExplicitEuler, Method::VelocityVerlet, Method::Rk4] {
        let is_finite = check::<f64, _, 1>(method, Oscillator { omega2: 10.0 }, start, 1.0, 3000);
        assert!(!is_finite, "{}", method.name());
    }
}

#[test]
fn exact_steps_in_parts_have_the_bits_of_the_compiled_ones() {
    // Steps of 0.6, 6, 63 and 630 radians have 2 to 1300 parts.
    for dt in [0.2, 2.0, 20.0, 200.0] {
        let model = Oscillator { omega2: 10.0 };
        let exact = Exact::new::<1>(model, dt).expect("a valid start");
        let start = State { q: [1.0], v: [0.5] };
        let mut simulator =
            Simulator::new(Model::<1>::on::<f64>(&model), exact, start, dt).expect("a valid start");
        simulator.run(20, &mut ()).expect("a valid start");
        let dynamics = Dynamics::of::<1>(&model, None);
        let mut own = Trajectory::exact(exact, &dynamics, &[1.0, 0.5], dt);
        assert!(own.advance(20));
        let State { q: [q], v: [v] } = simulator.sample().state;
        assert_eq!((own.state(), own.time()), (&[q, v][..], simulator.sample().time), "{dt}");
    }
}
