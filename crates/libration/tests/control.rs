//! Loops that are simulated, beside what theory says of them.

#![allow(clippy::unwrap_used)]

use libration::analysis::{Feedback, Jitter, Latency, Plant};
use libration::control::{Clock, ControlLoop, Jittered};
use libration::integrator::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration::system::Oscillator;
use libration::{Integrator, Method, State, with_method};
use proptest::prelude::*;

const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// Whether a simulated loop grows, from how `ln |y|` changes over many steps; and by how much a step.
fn growth(method: Method, omega2: f64, dt: f64, feedback: Feedback, latency: Latency) -> f64 {
    const STEPS: u32 = 20_000;
    let state = State { q: [1.0], v: [0.3] };
    let system = Oscillator { omega2 };
    with_method!(method, |m| {
        let mut all = ControlLoop::new(system, m, feedback, latency, state, [0.0]);
        // Sizes over two long windows: phases matter less than 1/STEPS.
        let mut sizes = [0.0_f64; 2];
        for size in &mut sizes {
            for _ in 0..STEPS / 2 {
                all.advance(dt);
                let State { q: [q], v: [v] } = *all.state();
                let now = (omega2 * q * q + v * v).ln() / 2.0;
                // Out of range: grown or fallen as far as floats go.
                if !now.is_finite() || now.abs() > 600.0 {
                    return now.signum() * if now.is_nan() { -1.0 } else { 1.0 };
                }
                *size += now;
            }
        }
        // The windows lie STEPS/2 apart.
        (sizes[1] - sizes[0]) / f64::from(STEPS / 2) / f64::from(STEPS / 2)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_loop_is_stable_in_simulation_where_its_spectral_radius_says_so(
        omega2 in 0.5..20.0_f64,
        dt in 0.005..0.15_f64,
        position in -0.5..15.0_f64,
        velocity in 0.0..4.0_f64,
        whole in 0..12_u32,
        part in prop_oneof![Just(0.0), 0.01..0.99_f64],
        method in prop::sample::select(vec![
            Method::ExplicitEuler, Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4,
        ]),
    ) {
        let feedback = Feedback { position, velocity };
        let latency = Latency::of_steps(f64::from(whole) + part).unwrap();
        let model = Oscillator { omega2 };
        let plant = with_method!(method, |m| Plant::new(m, model, ORIGIN, dt));
        let rate = plant.spectral_radius(feedback, latency).to_f64().ln();
        let simulated = growth(method, omega2, dt, feedback, latency);
        // What 20 000 steps do not tell apart: rates that move ln |y| by less than its waves.
        prop_assume!(rate.abs() > 1e-4);
        prop_assert_eq!(rate > 0.0, simulated > 0.0, "{} {}", rate, simulated);
    }
}

#[test]
fn a_simulated_loop_grows_at_the_rate_of_its_spectral_radius() {
    // An analytical test of a delay of whole steps, and of one with a part.
    let feedback = Feedback { position: 0.0, velocity: 1.0 };
    for steps in [0.0, 1.0, 42.0, 100.0, 100.25, 173.5] {
        let latency = Latency::of_steps(steps).unwrap();
        let plant = Plant::new(VelocityVerlet, Oscillator { omega2: 10.0 }, ORIGIN, 0.01);
        let rate = plant.spectral_radius(feedback, latency).to_f64().ln();
        let found = growth(Method::VelocityVerlet, 10.0, 0.01, feedback, latency);
        let out_of_range = found.abs() == 1.0;
        // The waves of ln |y| are below one: 1e-4 over ten thousand steps.
        assert!(
            out_of_range && found == rate.signum() || (found - rate).abs() < 1e-4,
            "{steps}: {found} {rate}"
        );
    }
}

#[test]
fn explicit_euler_is_symplectic_euler_with_the_force_one_step_late_bit_for_bit() {
    let (omega2, dt) = (10.0, 0.01);
    let start = State { q: [1.0], v: [0.25] };
    // Nothing but the late command acts; before it arrives, nothing.
    let free = Oscillator { omega2: 0.0 };
    let feedback = Feedback { position: omega2, velocity: 0.0 };
    let late = Latency::of_steps(1.0).unwrap();
    let mut delayed = ControlLoop::new(free, SymplecticEuler, feedback, late, start, [0.0]);
    let mut euler = start;
    for step in 0..1000 {
        delayed.advance(dt);
        let before = euler.v;
        euler = ExplicitEuler.step(&Oscillator { omega2 }, euler, dt);
        // Its velocity is the one that explicit Euler had a step before.
        assert_eq!((delayed.state().q, delayed.state().v), (euler.q, before), "{step}");
    }
}

#[test]
fn a_loop_that_is_restored_goes_on_bit_for_bit() {
    let feedback = Feedback { position: 3.0, velocity: 1.0 };
    let latency = Latency::of_steps(4.4).unwrap();
    let start = State { q: [1.0_f32], v: [0.0] };
    let fresh =
        || ControlLoop::new(Oscillator { omega2: 5.0 }, Rk4, feedback, latency, start, [0.5]);
    let mut whole = fresh();
    (0..7).for_each(|_| whole.advance(0.1));
    let (state, waiting, step) = (*whole.state(), whole.waiting().clone(), whole.step());
    (0..20).for_each(|_| whole.advance(0.1));
    let mut resumed = fresh();
    resumed.restore(state, waiting, step);
    (0..20).for_each(|_| resumed.advance(0.1));
    assert_eq!((resumed.state(), resumed.step()), (whole.state(), 27));
    assert_eq!(resumed.waiting(), whole.waiting());
}

/// The mean of `v²` over trajectories whose steps jitter, and its standard error.
fn simulated(method: Method, clock: Jittered, feedback: Feedback, steps: u64) -> [f64; 2] {
    const COUNT: u64 = 4000;
    let now = Latency::of_steps(0.0).unwrap();
    let start = State { q: [1.0], v: [0.5] };
    let square = |n: u64| {
        let system = Oscillator { omega2: 10.0 };
        with_method!(method, |m| {
            let mut one = ControlLoop::new(system, m, feedback, now, start, [0.0]);
            (0..steps).for_each(|step| one.advance(clock.dt(n, step)));
            one.state().v[0] * one.state().v[0]
        })
    };
    let squares: Vec<f64> = (0..COUNT).map(square).collect();
    let mean = squares.iter().sum::<f64>() / COUNT as f64;
    let variance =
        squares.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (COUNT - 1) as f64;
    [mean, (variance / COUNT as f64).sqrt()]
}

#[test]
fn second_moments_under_jitter_are_within_three_standard_errors_of_theory() {
    let start = State { q: [1.0], v: [0.5] };
    let mut settings = 0;
    for method in [Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4] {
        for law in [
            Jitter::Gaussian(0.1),
            Jitter::Uniform(0.1),
            Jitter::Gaussian(0.25),
            Jitter::Uniform(0.4),
        ] {
            for feedback in [Feedback::default(), Feedback { position: 4.0, velocity: 0.2 }] {
                let clock = Jittered { dt: 0.1, law, seed: 20 };
                let model = Oscillator { omega2: 10.0 };
                let plant = with_method!(method, |m| Plant::new(m, model, ORIGIN, clock.dt));
                let [.., wanted] = plant.mean_square(feedback, law).moments(&start, 100);
                let [found, error] = simulated(method, clock, feedback, 100);
                settings += 1;
                assert!(
                    (found - wanted).abs() < 3.0 * error,
                    "{method:?} {law:?} {feedback:?}: {found} ± {error}, {wanted}"
                );
            }
        }
    }
    assert_eq!(settings, 24);
}
