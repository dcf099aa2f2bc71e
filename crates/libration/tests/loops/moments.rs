//! Means over many loops agree with theory within three standard errors.

use libration::analysis::Plant;
use libration::control::clock::{Jittered, Skewed};
use libration::control::controller::StateFeedback;
use libration::control::delay::Random;
use libration::control::{Feedback, Jitter, RandomLatency};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::system::{BaselineOnly, Oscillator};
use libration::{Method, State};

const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };
const START: State<f64, 1> = State { q: [1.0], v: [0.5] };
const COUNT: usize = 4000;
const SPRING: Oscillator<f64> = Oscillator { omega2: 10.0 };
// They are dispatched at each step: a loop is compiled once and not once for each method.
const METHODS: [Method; 3] = [Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4];

/// The mean of some numbers and its standard error.
fn mean(numbers: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = numbers.clone().count() as f64;
    let mean = numbers.clone().sum::<f64>() / count;
    let variance = numbers.map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0);
    [mean, (variance / count).sqrt()]
}

#[test]
fn second_moments_under_jitter_are_within_three_standard_errors_of_theory() {
    let mut settings = 0;
    for method in METHODS {
        for law in [
            Jitter::Gaussian(0.1),
            Jitter::Uniform(0.1),
            Jitter::Gaussian(0.25),
            Jitter::Uniform(0.4),
            // Some steps of these would be negative.
            Jitter::Gaussian(0.6),
            Jitter::Uniform(0.9),
        ] {
            for feedback in [Feedback::default(), Feedback { position: 4.0, velocity: 0.2 }] {
                let plant = Plant::new(method, SPRING, ORIGIN, 0.1);
                let [.., wanted] = plant.mean_square(feedback, law).moments(&START, 100);
                let [found, error] = {
                    let setup = Setup::new(All(BaselineOnly(SPRING)), method)
                        .controller(StateFeedback::to_origin(feedback))
                        .clock(Jittered(law));
                    let starts = [START; COUNT];
                    let mut all =
                        Loops::new(setup, 0.1, 20, [0.0], &starts, Execution::serial()).unwrap();
                    all.advance(100).unwrap();
                    mean(all.trajectories().v(0).iter().map(|v| v * v))
                };
                settings += 1;
                assert!(
                    (found - wanted).abs() < 3.0 * error,
                    "{method:?} {law:?} {feedback:?}: {found} ± {error}, {wanted}"
                );
            }
        }
    }
    assert_eq!(settings, 36);
}

#[test]
fn means_over_asynchronous_clocks_are_within_three_standard_errors_of_theory() {
    let mut settings = 0;
    for method in METHODS {
        for dt in [0.01, 0.05] {
            for law in [
                Jitter::Gaussian(0.01),
                Jitter::Uniform(0.01),
                Jitter::Gaussian(0.02),
                Jitter::Uniform(0.03),
            ] {
                let plant = Plant::new(method, SPRING, ORIGIN, dt);
                // A third of the time in which the mean falls to 1/e.
                let steps = (plant.dephasing_steps(law).unwrap().to_f64() / 3.0) as u64;
                let wanted = plant.asynchronous_mean(&START, law, steps).q[0];
                let [found, error] = {
                    let setup = Setup::new(All(BaselineOnly(SPRING)), method).clock(Skewed(law));
                    let starts = [START; COUNT];
                    let mut all =
                        Loops::new(setup, dt, 8, [0.0], &starts, Execution::serial()).unwrap();
                    all.advance(steps).unwrap();
                    mean(all.trajectories().q(0).iter().copied())
                };
                settings += 1;
                assert!(
                    (found - wanted).abs() < 3.0 * error,
                    "{method:?} {law:?} {dt}: {found} ± {error}, {wanted}"
                );
            }
        }
    }
    assert_eq!(settings, 24);
}

#[test]
fn second_moments_under_random_latency_are_within_three_standard_errors_of_theory() {
    let mut settings = 0;
    for method in METHODS {
        for hold in [0.0, 0.5, 0.9] {
            for table in [
                vec![(0.0, 0.5), (2.0, 0.5)],
                vec![(0.0, 0.2), (1.0, 0.5), (3.0, 0.3)],
                vec![(0.25, 0.4), (1.0, 0.3), (2.5, 0.3)],
                vec![(1.0, 1.0)],
                vec![(1.5, 1.0)],
            ] {
                let feedback = Feedback { position: 3.0, velocity: 1.0 };
                let latency = RandomLatency::new(table, hold).unwrap();
                let plant = Plant::new(method, SPRING, ORIGIN, 0.1);
                let [.., wanted] = plant.moments_late(feedback, &latency, &START, 40);
                let [found, error] = {
                    let setup = Setup::new(All(BaselineOnly(SPRING)), method)
                        .controller(StateFeedback::to_origin(feedback))
                        .delay(Random(&latency));
                    let starts = [START; COUNT];
                    let mut all =
                        Loops::new(setup, 0.1, 5, [0.0], &starts, Execution::serial()).unwrap();
                    all.advance(40).unwrap();
                    mean(all.trajectories().v(0).iter().map(|v| v * v))
                };
                settings += 1;
                // What is not random at all differs by rounding.
                let rounding = 1e-12 * wanted.abs();
                assert!(
                    (found - wanted).abs() < 3.0 * error + rounding,
                    "{method:?} {latency:?}: {found} ± {error}, {wanted}"
                );
            }
        }
    }
    assert_eq!(settings, 45);
}
