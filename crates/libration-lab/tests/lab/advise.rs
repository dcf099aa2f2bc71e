//! What is advised, beside simulations that know nothing of how it was found.

use std::sync::atomic::AtomicBool;

use libration::analysis::{Feedback, Jitter, Latency};
use libration::control::Schedule;
use libration::control::clock::Rates;
use libration::control::controller::StateFeedback;
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::Exact;
use libration::random::{Address, Purpose};
use libration::system::{Oscillator, Pendulum};
use libration::{AnySystem, State};
use libration_lab::advise::{
    self, Advice, AdviseError, Budget, Control, Kind, Law, Measure, Request, Tolerance,
};
use libration_lab::{Config, Effort, Lab, Silent};

use super::advise_steps::free;

fn with_lab<R>(work: impl FnOnce(&Lab<'_>) -> R) -> R {
    let (config, stop) = (Config::default(), AtomicBool::new(false));
    work(&Lab::new(&config, Effort::Quick, &Silent, &stop))
}

pub(crate) fn advice(request: &Request) -> Result<Advice, AdviseError> {
    with_lab(|lab| advise::advise(lab, request))
}

/// A number from `low` to `high`.
fn drawn(step: u64, low: f64, high: f64) -> f64 {
    let [u, _] = Address { seed: 3, trajectory: 0, step, purpose: Purpose::Variation }.uniform();
    low + (high - low) * u
}

#[derive(Clone, Copy, Debug)]
struct Case {
    omega2: f64,
    gains: Feedback,
    period: f64,
}

impl Case {
    fn request(self) -> Request {
        Request {
            system: AnySystem::Oscillator(Oscillator { omega2: self.omega2 }),
            q: vec![0.0],
            v: vec![0.0],
            control: Some(Control {
                law: Law::Pd(self.gains),
                period: self.period,
                latency: 0.0,
                jitter: Jitter::Uniform(0.0),
                skew: 0.0,
                loss: 0.0,
                record: None,
                weights: None,
                deviation: 0.1,
            }),
            tolerance: Tolerance { of: Measure::Trajectory, most: 1e-3 },
            horizon: 5.0,
            rollout: [64, 64],
            map: false,
            asked_by: String::new(),
        }
    }

    /// By how much `ln |y|` of a simulated loop changes in a period, between two long windows.
    fn growth(self, latency: f64, skew: f64) -> f64 {
        const PERIODS: u64 = 6_000;
        let model = Oscillator { omega2: self.omega2 };
        let latency = Latency::of_steps(latency / self.period).unwrap();
        let rates = [1.0 + skew];
        let exact = Exact::new::<1>(model, self.period * (1.0 + skew)).unwrap();
        let setup = Setup::new(All(model), exact)
            .controller(StateFeedback::to_origin(self.gains))
            .clock(Rates(&rates))
            .delay(Schedule::late(latency));
        let start = [State { q: [1.0], v: [0.3] }];
        let mut one =
            Loops::new(setup, self.period, 0, [0.0], &start, Execution::serial()).unwrap();
        let mut means = [0.0; 2];
        one.advance(PERIODS / 4).unwrap();
        for mean in &mut means {
            for _ in 0..PERIODS {
                one.advance(1).unwrap();
                let State { q: [q], v: [v] } = one.state(0).unwrap();
                let size = (self.omega2.max(1.0) * q * q + v * v).ln() / 2.0;
                // Beyond the floats it is plain what it does.
                if !size.is_finite() || size.abs() > 300.0 {
                    return if size > 0.0 || size.is_nan() { 1.0 } else { -1.0 };
                }
                *mean += size / PERIODS as f64;
            }
        }
        (means[1] - means[0]) / PERIODS as f64
    }

    /// The factor by which second moments grow in a period, of steps that are drawn: an oscillator in closed form, each
    /// deviation with its mirror image.
    fn mean_square(self, rms: f64) -> f64 {
        const DRAWS: u64 = 200_000;
        let omega = self.omega2.sqrt();
        let mut operator = [[0.0; 3]; 3];
        for step in 0..DRAWS / 2 {
            let width = rms * 3.0_f64.sqrt();
            let epsilon = drawn(step, -width, width);
            for epsilon in [epsilon, -epsilon] {
                let h = self.period * (1.0 + epsilon).max(0.0);
                let (sine, cosine) = (omega * h).sin_cos();
                let gamma = [(1.0 - cosine) / self.omega2, sine / omega];
                let Feedback { position, velocity } = self.gains;
                let a = cosine - gamma[0] * position;
                let b = sine / omega - gamma[0] * velocity;
                let c = -omega * sine - gamma[1] * position;
                let d = cosine - gamma[1] * velocity;
                let square = [
                    [a * a, 2.0 * a * b, b * b],
                    [a * c, a * d + b * c, b * d],
                    [c * c, 2.0 * c * d, d * d],
                ];
                for (row, square) in operator.iter_mut().zip(square) {
                    row.iter_mut().zip(square).for_each(|(sum, x)| *sum += x / DRAWS as f64);
                }
            }
        }
        let mut state = [1.0, 0.1, 1.0];
        let mut growth = 1.0;
        for _ in 0..20_000 {
            let moved = operator.map(|row| row.iter().zip(state).map(|(a, x)| a * x).sum::<f64>());
            growth = moved.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            state = moved.map(|x| x / growth);
        }
        growth
    }
}

#[test]
fn of_a_hundred_random_loops_each_budget_ends_where_simulations_become_unstable() {
    let mut tried = [0; 3];
    let cases = (0..).map(|i| Case {
        omega2: drawn(1000 + 4 * i, 0.5, 30.0),
        gains: Feedback {
            position: drawn(1001 + 4 * i, 0.0, 30.0),
            velocity: drawn(1002 + 4 * i, 0.3, 8.0),
        },
        period: drawn(1003 + 4 * i, 0.02, 0.4),
    });
    let (mut loops, mut skipped) = (0, 0);
    for case in cases {
        let budgets = with_lab(|lab| advise::budgets(lab, &case.request()));
        let budgets: Vec<Budget> = match budgets {
            Ok(budgets) => budgets,
            Err(AdviseError::Unstable { .. }) => {
                skipped += 1;
                assert!(case.growth(0.0, 0.0) > 0.0, "{case:?}");
                continue;
            }
            Err(error) => panic!("{case:?}: {error}"),
        };
        for (i, kind) in [Kind::Latency, Kind::Jitter, Kind::Skew].into_iter().enumerate() {
            let budget = budgets.iter().find(|budget| budget.kind == kind).unwrap();
            let Some(limit) = budget.stable_up_to else { continue };
            tried[i] += 1;
            let grows = |share: f64| match kind {
                Kind::Latency => case.growth(share * limit, 0.0) > 0.0,
                Kind::Skew => case.growth(0.0, share * limit) > 0.0,
                _ => case.mean_square(share * limit) > 1.0,
            };
            assert!(!grows(0.98), "{case:?}: {kind:?} {limit}");
            assert!(grows(1.02), "{case:?}: {kind:?} {limit}");
        }
        loops += 1;
        if loops == 100 {
            break;
        }
    }
    // Late enough every loop fails, and slow enough most; of jitter many bear all that there is.
    assert!(tried[0] == 100 && tried[2] > 60 && tried[1] > 15, "{tried:?}, {skipped} unstable");
}

#[test]
fn the_cost_is_finite_below_a_budget_and_infinite_above() {
    use libration::analysis::{Imperfections, LqrWeights, Plant};
    let case =
        Case { omega2: 10.0, gains: Feedback { position: 10.0, velocity: 2.0 }, period: 0.05 };
    let budgets = with_lab(|lab| advise::budgets(lab, &case.request())).unwrap();
    let model = Oscillator { omega2: case.omega2 };
    let plant = Plant::exact(model, State { q: [0.0], v: [0.0] }, case.period);
    let weights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.0 };
    let mut tried = 0;
    for budget in budgets {
        let Some(limit) = budget.stable_up_to else { continue };
        for (share, finite) in [(0.98, true), (1.02, false)] {
            let (size, none) = (share * limit, Imperfections::NONE);
            let imperfections = match budget.kind {
                Kind::Latency => Imperfections {
                    latency: Latency::of_seconds(size, case.period).unwrap(),
                    ..none
                },
                Kind::Jitter => Imperfections { jitter: Jitter::Uniform(size), ..none },
                Kind::Skew => Imperfections { skew: size, ..none },
                Kind::Loss => Imperfections { loss: size, ..none },
            };
            let cost = plant.cost(&case.gains.into(), &imperfections, weights).unwrap();
            assert_eq!(cost.is_finite(), finite, "{budget:?} {share}: {cost}");
            tried += 1;
        }
    }
    assert!(tried >= 4, "{tried}");
}

#[test]
fn a_loop_that_stands_all_that_is_stated_is_simulated_as_predicted() {
    let case =
        Case { omega2: 10.0, gains: Feedback { position: 10.0, velocity: 2.0 }, period: 0.02 };
    let mut request = case.request();
    if let Some(control) = &mut request.control {
        (control.latency, control.jitter) = (0.03, Jitter::Gaussian(0.1));
        (control.skew, control.loss) = (1e-3, 0.05);
    }
    let found = advice(&request).unwrap();
    let looped = found.looped.as_ref().unwrap();
    let simulated = looped.together.simulated.unwrap();
    let off = (simulated.cost - simulated.predicted) / simulated.error;
    assert!(off.abs() < 3.0 && simulated.error < 0.02 * simulated.cost, "{simulated:?}");
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    // The latency is nearest to its limit, and swings there.
    let failing = looped.fails_first.as_ref().unwrap();
    assert_eq!(failing.kind, Kind::Latency);
    assert!((0.5..1.2).contains(&failing.frequency.unwrap()), "{failing:?}");
    // All of it together leaves less room than the worst alone.
    let room = looped.together.room.unwrap();
    assert!(room > 1.0 && room < 1.0 / failing.used, "{room} {failing:?}");
}

#[test]
fn a_linearisation_that_a_simulation_contradicts_is_told_loudly() {
    // Held upright by a motor that is weak: from 1 rad off it falls.
    let gains = libration::control::controller::PidGains {
        proportional: 30.0,
        integral: 0.0,
        derivative: 6.0,
        filter: 0.0,
        most: 4.0,
        tracking: 1.0,
        target: [0.0],
    };
    let case =
        Case { omega2: 9.81, gains: Feedback { position: 0.0, velocity: 0.0 }, period: 0.01 };
    let request = |deviation: f64| {
        let mut request = case.request();
        request.system = AnySystem::Pendulum(Pendulum { omega2: 9.81 });
        request.q = vec![std::f64::consts::PI];
        if let Some(control) = &mut request.control {
            control.law = Law::Pid(gains);
            control.deviation = deviation;
        }
        request
    };
    let near = advice(&request(0.05)).unwrap();
    assert!(!near.warnings.iter().any(|w| w.contains("contradicts")), "{:?}", near.warnings);
    let far = advice(&request(1.0)).unwrap();
    assert!(far.warnings[0].contains("contradicts the linearisation"), "{:?}", far.warnings);
    let returns = far.looped.unwrap().together.returns.unwrap();
    assert!(returns.up_to > 0.1 && returns.up_to < 1.0, "{returns:?}");
}

#[test]
fn what_cannot_be_advised_on_is_refused_before_any_work() {
    let case =
        Case { omega2: 10.0, gains: Feedback { position: -20.0, velocity: 1.0 }, period: 0.02 };
    let told = |request: &Request| advice(request).unwrap_err().to_string();
    let unstable = told(&case.request());
    assert!(
        unstable.contains("unstable even without") && unstable.contains("without a swing"),
        "{unstable}"
    );
    let damped = Case { gains: Feedback { position: 10.0, velocity: -1.0 }, ..case };
    assert!(told(&damped.request()).contains("it swings at 0.7"), "{}", told(&damped.request()));
    let mut energy = Case { gains: Feedback { position: 10.0, velocity: 1.0 }, ..case }.request();
    energy.tolerance.of = Measure::Energy;
    assert!(told(&energy).contains("a loop does not conserve it"), "{}", told(&energy));
    let oscillator = AnySystem::Oscillator(Oscillator { omega2: 10.0 });
    let cost = free(oscillator, &[1.0], &[0.0], Measure::Cost, 0.1, 10.0);
    assert!(told(&cost).contains("only a loop costs"));
    let rest = free(oscillator, &[0.0], &[0.0], Measure::Energy, 0.1, 10.0);
    assert!(told(&rest).contains("the energy at the start is zero"));
    let many = free(oscillator, &[1.0; 3], &[0.0; 3], Measure::Energy, 0.1, 10.0);
    assert!(told(&many).contains("3 degrees of freedom"));
}
