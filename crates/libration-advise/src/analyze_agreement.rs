//! Tests that `analyze` and `advise` agree on loops.

use libration::control::{Feedback, Jitter};
use libration::random::{Address, Purpose};
use libration::{AnySystem, catalog};

use libration_analyze::{LatencyOption, Stepping, Timing};
use libration_settings::equations::EquationSystem;

use super::control::{Control, Law};
use super::loops::{Loop, PlantModel};
use super::request::{Measure, Request, Tolerance};

/// Number of compared loops.
const LOOPS: u64 = 200;

/// The random numbers of one loop.
struct Draws {
    trajectory: u64,
    step: u64,
}

impl Draws {
    fn next(&mut self, low: f64, high: f64) -> f64 {
        self.step += 1;
        let Draws { trajectory, step } = *self;
        let [u, _] = Address { seed: 11, trajectory, step, purpose: Purpose::Variation }.uniform();
        low + (high - low) * u
    }
}

/// A random loop with losses: with or without mass, damping, latency and jitter.
fn random_loop(index: u64) -> Request {
    let mut draw = Draws { trajectory: index, step: 0 };
    let omega2 = draw.next(1.0, 40.0);
    let mass = if index.is_multiple_of(2) { 1.0 } else { draw.next(0.2, 5.0) };
    let mut parameters = match index % 2 {
        0 => vec![("omega2", omega2)],
        _ => vec![("m", mass), ("k", mass * omega2)],
    };
    let damped = index.is_multiple_of(3);
    if damped {
        parameters.push(("gamma", draw.next(0.0, 4.0)));
    }
    let name = if damped { "damped-oscillator" } else { "oscillator" };
    let (system, actuation) = catalog::build(name, &parameters).unwrap();
    let gains = Feedback {
        position: mass * draw.next(0.0, 2.0 * omega2),
        velocity: mass * draw.next(0.2, 2.0) * omega2.sqrt(),
    };
    let period = draw.next(0.05, 0.4) / omega2.sqrt();
    let latency = match index % 4 {
        0 => 0.0,
        1 => draw.next(0.0, 4.0).floor() * period,
        _ => draw.next(0.0, 3.0) * period,
    };
    let rms = draw.next(0.01, 0.3);
    let control = Control {
        law: Law::Pd(gains),
        period,
        latency,
        jitter: match index % 5 {
            0 => Jitter::Gaussian(0.0),
            1 | 2 => Jitter::Uniform(rms),
            _ => Jitter::Gaussian(rms),
        },
        skew: if index.is_multiple_of(7) { draw.next(-0.05, 0.05) } else { 0.0 },
        loss: draw.next(0.01, 0.8),
        record: None,
        weights: None,
        deviation: 0.1,
    };
    let rest = Some(&[0.0][..]);
    let system = EquationSystem::of_catalogue((system, actuation), rest, rest).unwrap();
    let tolerance = Tolerance { of: Measure::Trajectory, most: 1e-3 };
    Request { control: Some(control), rollout: [64, 64], ..Request::new(system, tolerance, 5.0) }
}

/// The request that a printed `libration analyze` makes.
fn read(command: &str) -> libration_analyze::Request {
    let words: Vec<&str> = command.split_whitespace().collect();
    assert_eq!(words[..2], ["libration", "analyze"], "{command}");
    let (mut name, mut parameters, mut dt, mut timing) = ("", vec![], 0.0, Timing::default());
    let number = |text: &str| -> f64 { text.parse().unwrap() };
    for pair in words[2..].chunks(2) {
        let [flag, value] = *pair else { panic!("{command}") };
        match flag {
            "--system" => name = value,
            "--set" => {
                let (key, value) = value.split_once('=').unwrap();
                parameters.push((key, number(value)));
            }
            "--dt" => dt = number(value),
            "--feedback" => {
                let (kp, kd) = value.split_once(',').unwrap();
                timing.feedback = Some(Feedback { position: number(kp), velocity: number(kd) });
            }
            "--latency" => {
                timing.latency = Some(match value.strip_suffix("steps") {
                    Some(steps) => LatencyOption::Steps(number(steps)),
                    None => LatencyOption::Seconds(number(value)),
                });
            }
            "--jitter" => {
                let (law, rms) = value.split_once(':').unwrap();
                timing.jitter = Some(match law {
                    "uniform" => Jitter::Uniform(number(rms)),
                    _ => Jitter::Gaussian(number(rms)),
                });
            }
            "--loss" => timing.loss = Some(number(value)),
            "--q" => assert_eq!(value, "0"),
            "--integrator" => assert_eq!(value, "exact"),
            _ => panic!("{flag} of {command}"),
        }
    }
    let built = catalog::build(name, &parameters).unwrap();
    let rest = Some(&[0.0][..]);
    libration_analyze::Request {
        system: EquationSystem::of_catalogue(built, rest, rest).unwrap(),
        stepping: Stepping::Exact,
        dt,
        steps: 1,
        criteria: libration_analyze::Criteria::default(),
        timing,
    }
}

fn compare(model: impl PlantModel, request: &Request) {
    let one = Loop::new(model, request, request.control.as_ref().unwrap()).unwrap();
    let stated = one.timed.stated().unwrap();
    let wanted = one.timed.growth(&stated).unwrap();
    let command = one.command(&stated, request);
    let growth = libration_analyze::loop_growth(&read(&command)).unwrap().unwrap();
    let found = growth.mean_square_growth.unwrap();
    // Both take the same operator; a latency in seconds and a time step that were printed and read again differ by a rounding or
    // two, and where the largest eigenvalues meet that is magnified to its root.
    assert!((found - wanted.exp_m1()).abs() < 1e-7, "{found} {wanted} {command}");
    let radius = growth.mean_square_radius.unwrap();
    assert!((radius - 1.0 - found).abs() < 1e-15 * radius.max(1.0), "{radius} {found}");
    assert_eq!(growth.lyapunov_exponent, None, "{command}");
}

#[test]
fn analyze_and_advise_agree_on_loops_whose_commands_are_lost() {
    for index in 0..LOOPS {
        let request = random_loop(index);
        match request.system.twin.unwrap().system {
            AnySystem::Oscillator(model) => compare(model, &request),
            AnySystem::DampedOscillator(model) => compare(model, &request),
            _ => unreachable!(),
        }
    }
}
