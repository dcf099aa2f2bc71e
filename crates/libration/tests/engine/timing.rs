//! Timing of a loop, against independent values of 30 digits.

use libration::State;
use libration::analysis::Plant;
use libration::control::{Feedback, Jitter, Latency, RandomLatency};
use libration::integrator::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration::system::{DampedOscillator, Oscillator};
use proptest::prelude::*;
use serde_json::Value;

const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

fn reference(table: &str) -> Vec<(Vec<String>, Value)> {
    let all: Value = serde_json::from_str(include_str!("../reference/timing.json")).unwrap();
    let table = all[table].as_object().unwrap();
    let key = |key: &str| key.split('|').map(str::to_owned).collect();
    table.iter().map(|(name, value)| (key(name), value.clone())).collect()
}

/// A number after `=`, or of the reference, which quotes some.
fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str()?.parse().ok()).unwrap()
}

fn after(text: &str) -> f64 {
    text.split_once('=').unwrap().1.parse().unwrap()
}

fn feedback(text: &str) -> Feedback {
    let (kp, kd) = text.trim_start_matches("K=").split_once(',').unwrap();
    Feedback { position: kp.parse().unwrap(), velocity: kd.parse().unwrap() }
}

fn plant(method: &str, dt: f64) -> Plant<'static> {
    let model = Oscillator { omega2: 10.0 };
    match method {
        "explicit_euler" => Plant::new(ExplicitEuler, model, ORIGIN, dt),
        "semi_implicit" => Plant::new(SymplecticEuler, model, ORIGIN, dt),
        "velocity_verlet" => Plant::new(VelocityVerlet, model, ORIGIN, dt),
        "rk4" => Plant::new(Rk4, model, ORIGIN, dt),
        "exact_zoh" => Plant::exact(model, ORIGIN, dt),
        other => panic!("{other}"),
    }
}

/// The reference has so many digits that ten of them are ours to meet, and mostly thirteen are met.
fn close(found: f64, wanted: f64, what: &dyn std::fmt::Debug) {
    assert!((found / wanted - 1.0).abs() < 1e-11, "{what:?}: {found:e}, {wanted:e}");
}

#[test]
fn the_delay_margin_is_that_of_the_continuous_loop() {
    for (key, value) in reference("tau_c_continuous") {
        let margin = plant("rk4", 0.01).delay_margin(feedback(&key[0])).unwrap();
        close(libration::number::Wide::to_f64(margin), number(&value), &key);
    }
}

#[test]
fn critical_latencies_are_the_closed_forms() {
    for (key, value) in reference("critical_steps") {
        let windows = plant(&key[2], after(&key[0])).latency_windows(feedback(&key[1]));
        match windows.critical() {
            Some(critical) => close(critical, number(&value), &key),
            None => assert!(value.is_null(), "{key:?}: {value}"),
        }
    }
}

#[test]
fn spectral_radii_are_those_of_the_augmented_matrices() {
    for (key, values) in reference("rho") {
        let (plant, feedback) = (plant(&key[2], after(&key[0])), feedback(&key[1]));
        for (steps, value) in values.as_object().unwrap() {
            let latency = Latency::of_steps(steps.parse().unwrap()).unwrap();
            let radius = plant.spectral_radius(feedback, latency).to_f64();
            close(radius, number(value), &(&key, steps));
        }
    }
}

#[test]
fn second_moments_grow_as_exact_moments_of_the_law_say() {
    for (key, value) in reference("rho_meansquare_minus_1") {
        let rms = after(&key[1]);
        let law = if key[2] == "gauss" { Jitter::Gaussian(rms) } else { Jitter::Uniform(rms) };
        let moments = plant(&key[3], after(&key[0])).mean_square(Feedback::default(), law);
        let one: libration::number::Wide = libration::Scalar::one();
        let growth = moments.radius - one;
        close(growth.to_f64(), number(&value), &key);
    }
}

#[test]
fn a_loop_becomes_stable_again_at_a_larger_latency() {
    let feedback = Feedback { position: 0.0, velocity: 1.0 };
    let plant = plant("exact_zoh", 0.01);
    let windows = plant.latency_windows(feedback);
    let whole: Vec<_> = windows
        .stable
        .iter()
        .map(|&(from, to)| (from.ceil() as u64, to.unwrap().floor() as u64))
        .collect();
    assert_eq!(whole[..2], [(0, 41), (174, 211)]);
    // Beside the radius at each of these latencies.
    for steps in [0.0, 41.0, 42.0, 173.0, 174.0, 211.0, 212.0] {
        let radius = plant.spectral_radius(feedback, Latency::of_steps(steps).unwrap()).to_f64();
        let inside = whole.iter().any(|&(from, to)| (from..=to).contains(&(steps as u64)));
        assert_eq!(radius < 1.0, inside, "{steps}: {radius}");
    }
}

#[test]
fn where_commands_split_steps_the_edge_is_that_of_the_radius_and_of_the_sampled_system() {
    let gains = Feedback { position: 10.0, velocity: 2.0 };
    let model = Oscillator { omega2: 10.0 };
    let origin = State { q: [0.0], v: [0.0] };
    // By the exponential of a matrix for each part of the step, elsewhere.
    let exact = Plant::exact(model, origin, 0.01);
    close(exact.split_critical_latency(gains).unwrap(), 15.3234267109, &"exact");
    let euler = Plant::new(SymplecticEuler, model, origin, 0.01);
    let edge = euler.split_critical_latency(gains).unwrap();
    // The textbook's λᵈ has it a tenth of a step later.
    assert!((edge - 15.44014).abs() < 1e-5, "{edge}");
    let radius = |d: f64| euler.spectral_radius(gains, Latency::of_steps(d).unwrap()).to_f64();
    assert!(radius(edge - 1e-9) < 1.0 && radius(edge + 1e-9) > 1.0);
}

#[test]
fn no_delay_unsettles_a_loop_whose_feedback_is_as_strong_as_its_spring_and_well_damped() {
    let gains = Feedback { position: 10.0, velocity: 2.0 };
    for gamma in [5.0, 100.0, 1000.0] {
        let model = DampedOscillator { omega2: 10.0, gamma };
        let plant = Plant::exact(model, State { q: [0.0], v: [0.0] }, 0.1);
        assert_eq!(plant.latency_windows(gains).stable, [(0.0, None)], "γ = {gamma}");
    }
}

#[test]
fn without_gains_no_latency_changes_anything() {
    let none = Feedback { position: 0.0, velocity: 0.0 };
    let plant = Plant::exact(Oscillator { omega2: 10.0 }, State { q: [0.0], v: [0.0] }, 0.01);
    for steps in [0.0, 1.5, 20.0, 1000.25] {
        let radius = plant.spectral_radius(none, Latency::of_steps(steps).unwrap()).to_f64();
        assert!((radius - 1.0).abs() < 1e-15, "{steps}: {radius}");
    }
}

#[test]
fn an_ensemble_of_clocks_falls_out_of_step_as_its_law_says() {
    let plant = plant("velocity_verlet", 0.01);
    // Computed with 30 digits from θ' = z/√(1 − z²/4): √2/(θ's) and 2.19912307/(√3·θ's).
    for (law, wanted) in [(Jitter::Gaussian(0.01), 4471.577), (Jitter::Uniform(0.01), 4014.529)] {
        let steps = plant.dephasing_steps(law).unwrap().to_f64();
        assert!((steps - wanted).abs() < 6e-4, "{law:?}: {steps}");
    }
    assert!(plant.dephasing_steps(Jitter::Gaussian(0.0)).is_none());
}

#[test]
fn a_typical_run_grows_at_the_exponent_of_the_transfer_operator() {
    // To the seven digits of the reference; and for weak noise z⁴σ²/8/(1 − z²/4).
    let exponent = |method, rms| {
        let (feedback, law) = (Feedback::default(), Jitter::Gaussian(rms));
        plant(method, 0.1).lyapunov_exponent(feedback, law).unwrap()
    };
    for (method, wanted) in [("semi_implicit", 1.284_107_9e-5), ("velocity_verlet", 3.355_775e-7)] {
        let found = exponent(method, 0.1);
        assert!((found / wanted - 1.0).abs() < 2e-7, "{method}: {found:e}");
    }
    let z2 = 10.0 * 0.1 * 0.1;
    let weak = z2 * z2 * 1e-4 / 8.0 / (1.0 - z2 / 4.0);
    assert!((exponent("semi_implicit", 0.01) / weak - 1.0).abs() < 1e-3);
    // An exact step of any length only turns.
    assert!(exponent("exact_zoh", 0.1).abs() < 1e-15);
}

#[test]
fn the_same_latencies_in_another_order_give_another_verdict() {
    // 0 or 2 steps with probability ½: drawn anew every step, or kept with probability ½. The values are eigenvalues of
    // the matrix (Pᵀ ⊗ 1)·diag(Mᵢ ⊗ Mᵢ) in floats, by another program.
    let feedback = Feedback { position: 10.0, velocity: 2.0 };
    let plant = plant("exact_zoh", 0.1);
    for (hold, wanted) in [(0.0, 0.995_086_647_407), (0.5, 1.015_545_489_573)] {
        let table = RandomLatency::new(vec![(0.0, 0.5), (2.0, 0.5)], hold).unwrap();
        let found = plant.mean_square_late(feedback, &table);
        assert!((found - wanted).abs() < 1e-12, "{hold}: {found}");
    }
    // A latency that is certain is no random one.
    for steps in [0.0, 1.0, 3.0, 0.25, 2.5] {
        let table = RandomLatency::new(vec![(steps, 1.0)], 0.3).unwrap();
        let latency = Latency::of_steps(steps).unwrap();
        let certain = plant.spectral_radius(feedback, latency).to_f64();
        close(plant.mean_square_late(feedback, &table).sqrt(), certain, &steps);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn whole_latencies_are_stable_where_the_windows_say_so(
        omega2 in 0.0..30.0_f64,
        gamma in prop_oneof![Just(0.0), -0.5..1.5_f64],
        dt in 0.002..0.25_f64,
        position in -3.0..25.0_f64,
        velocity in -1.0..6.0_f64,
        which in 0..5_usize,
    ) {
        let model = DampedOscillator { omega2, gamma };
        let plant = match which {
            0 => Plant::new(ExplicitEuler, model, ORIGIN, dt),
            1 => Plant::new(SymplecticEuler, model, ORIGIN, dt),
            2 => Plant::new(VelocityVerlet, model, ORIGIN, dt),
            3 => Plant::new(Rk4, model, ORIGIN, dt),
            _ => Plant::exact(model, ORIGIN, dt),
        };
        let feedback = Feedback { position, velocity };
        let windows = plant.latency_windows(feedback).stable;
        for steps in [0_u32, 1, 2, 3, 4, 5, 7, 10, 15, 23, 40] {
            let d = f64::from(steps);
            let radius = plant.spectral_radius(feedback, Latency::of_steps(d).unwrap()).to_f64();
            let inside =
                windows.iter().any(|&(from, to)| from <= d && to.is_none_or(|to| d <= to));
            prop_assert!(
                (radius - 1.0).abs() < 1e-9 || (radius < 1.0) == inside,
                "{} steps: {} {:?}", steps, radius, windows
            );
        }
    }
}
