//! The budgets of loops, beside simulations that know nothing of how they were found.

use libration::analysis::{
    Feedback, Imperfections, Jitter, Latency, LqrWeights, ObserverNoise, Plant,
};
use libration::control::clock::{Jittered, Rates};
use libration::control::controller::{Luenberger, Pid, PidGains, StateFeedback};
use libration::control::{Controller, Schedule};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::Exact;
use libration::random::{Address, Purpose};
use libration::system::Oscillator;
use libration::{AnySystem, State};
use libration_lab::advise::{
    self, AdviseError, Budget, Control, Correction, Kind, Law, Measure, Regulator, Request,
    Tolerance,
};

use super::advise::with_lab;

/// A number from `low` to `high`.
fn drawn(step: u64, low: f64, high: f64) -> f64 {
    let [u, _] = Address { seed: 3, trajectory: 0, step, purpose: Purpose::Variation }.uniform();
    low + (high - low) * u
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) omega2: f64,
    pub(crate) gains: Feedback,
    pub(crate) period: f64,
}

impl Case {
    pub(crate) fn request(self) -> Request {
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
    fn growth(self, controller: impl Controller<f64, 1>, latency: f64, skew: f64) -> f64 {
        const PERIODS: u64 = 6_000;
        let model = Oscillator { omega2: self.omega2 };
        let latency = Latency::of_steps(latency / self.period).unwrap();
        let rates = [1.0 + skew];
        let exact = Exact::new::<1>(model, self.period * (1.0 + skew)).unwrap();
        let setup = Setup::new(All(model), exact)
            .controller(controller)
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

    /// What the loop costs with this alone.
    fn cost(self, kind: Kind, size: f64) -> f64 {
        let none = Imperfections::NONE;
        let imperfections = match kind {
            Kind::Latency => {
                Imperfections { latency: Latency::of_seconds(size, self.period).unwrap(), ..none }
            }
            Kind::Jitter => Imperfections { jitter: Jitter::Uniform(size), ..none },
            Kind::Skew => Imperfections { skew: size, ..none },
            Kind::Loss => Imperfections { loss: size, ..none },
        };
        let model = Oscillator { omega2: self.omega2 };
        let plant = Plant::exact(model, State { q: [0.0], v: [0.0] }, self.period);
        let weights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.0 };
        plant.cost(&self.gains.into(), &imperfections, weights).unwrap()
    }

    fn feedback(self) -> StateFeedback<1> {
        StateFeedback::to_origin(self.gains)
    }

    /// What a period makes of `E[q²]`, `E[qv]` and `E[v²]`, measured of loops that are simulated with a jittered clock.
    fn simulated_operator(self, rms: f64) -> [[f64; 3]; 3] {
        // At 0.98 and 1.02 of a limit the growth is off by a 25th of what jitter adds, which is as the square of its rms; what a
        // draw adds is as its rms.
        let count = ((150.0 / rms).powi(2) as usize).clamp(100_000, 1_000_000);
        let model = Oscillator { omega2: self.omega2 };
        let exact = Exact::new::<1>(model, self.period).unwrap();
        let setup = Setup::new(All(model), exact)
            .controller(self.feedback())
            .clock(Jittered(Jitter::Uniform(rms)));
        let starts: Vec<State<f64, 1>> = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
            .into_iter()
            .flat_map(|[q, v]| std::iter::repeat_n(State { q: [q], v: [v] }, count))
            .collect();
        let mut loops =
            Loops::new(setup, self.period, 5, [0.0], &starts, Execution::serial()).unwrap();
        loops.advance(1).unwrap();
        let after = |start: usize| {
            let mut sums = [0.0; 3];
            for i in start * count..(start + 1) * count {
                let State { q: [q], v: [v] } = loops.state(i).unwrap();
                for (sum, x) in sums.iter_mut().zip([q * q, q * v, v * v]) {
                    *sum += x / count as f64;
                }
            }
            sums
        };
        let [qq, vv, both] = [0, 1, 2].map(after);
        [0, 1, 2].map(|i| [qq[i], both[i] - qq[i] - vv[i], vv[i]])
    }

    /// The factor by which those grow in a period.
    fn mean_square(self, rms: f64) -> f64 {
        let operator = self.simulated_operator(rms);
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
                assert!(case.growth(case.feedback(), 0.0, 0.0) > 0.0, "{case:?}");
                continue;
            }
            Err(error) => panic!("{case:?}: {error}"),
        };
        for (i, kind) in [Kind::Latency, Kind::Jitter, Kind::Skew].into_iter().enumerate() {
            let budget = budgets.iter().find(|budget| budget.kind == kind).unwrap();
            let Some(limit) = budget.stable_up_to else { continue };
            tried[i] += 1;
            let grows = |share: f64| match kind {
                Kind::Latency => case.growth(case.feedback(), share * limit, 0.0) > 0.0,
                Kind::Skew => case.growth(case.feedback(), 0.0, share * limit) > 0.0,
                _ => case.mean_square(share * limit) > 1.0,
            };
            for (share, stable) in [(0.98, true), (1.02, false)] {
                assert_eq!(!grows(share), stable, "{case:?}: {kind:?} {limit} {share}");
                let cost = case.cost(kind, share * limit);
                assert_eq!(cost.is_finite(), stable, "{case:?}: {kind:?} {limit} {share}: {cost}");
            }
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
fn controllers_that_remember_fail_where_they_are_said_to() {
    let case =
        Case { omega2: 10.0, gains: Feedback { position: 0.0, velocity: 0.0 }, period: 0.05 };
    let gains = PidGains {
        proportional: 12.0,
        integral: 3.0,
        derivative: 3.0,
        filter: 0.02,
        most: f64::INFINITY,
        tracking: 1.0,
        target: [0.0],
    };
    let weights = LqrWeights { position: 40.0, velocity: 1.0, command: 0.1 };
    let noise = ObserverNoise { acceleration: 1.0, position: 1e-4 };
    let plant =
        Plant::exact(Oscillator { omega2: 10.0 }, State { q: [0.0], v: [0.0] }, case.period);
    let designed =
        Luenberger::to_origin(plant.lqr(weights).unwrap(), plant.observer(noise).unwrap());
    let given = Law::Observer {
        feedback: Regulator::Gains(designed.gains),
        correction: Correction::Gains(designed.observer.correction),
    };
    let made =
        Law::Observer { feedback: Regulator::Lqr(weights), correction: Correction::Kalman(noise) };
    let limits = |law: Law| -> [f64; 2] {
        let mut request = case.request();
        if let Some(control) = &mut request.control {
            control.law = law;
        }
        let budgets = with_lab(|lab| advise::budgets(lab, &request)).unwrap();
        [Kind::Latency, Kind::Skew].map(|kind| {
            let found = budgets.iter().find(|budget| budget.kind == kind).unwrap();
            found.stable_up_to.unwrap()
        })
    };
    fn shown<C: Controller<f64, 1> + Copy>(
        case: Case,
        name: &str,
        controller: C,
        limits: [f64; 2],
    ) {
        for (share, grows) in [(0.98, false), (1.02, true)] {
            let [latency, skew] = limits.map(|limit| share * limit);
            let late = case.growth(controller, latency, 0.0);
            assert_eq!(late > 0.0, grows, "{name} {latency} s late: {late}");
            let slow = case.growth(controller, 0.0, skew);
            assert_eq!(slow > 0.0, grows, "{name} {skew} slow: {slow}");
        }
    }
    shown(case, "pid", Pid::new(gains).unwrap(), limits(Law::Pid(gains)));
    shown(case, "observer", designed, limits(made));
    assert_eq!(limits(given), limits(made));
}

#[test]
fn a_clock_that_is_replayed_is_predicted_step_by_step() {
    let case =
        Case { omega2: 10.0, gains: Feedback { position: 0.0, velocity: 12.0 }, period: 0.1 };
    // Long steps of a period and three quarters alone let the loop grow; a law of that rms, and steps in turn, do not.
    let replayed = |block: usize, loss: f64| {
        let step = |i: usize| if (i / block).is_multiple_of(2) { 0.175 } else { 0.025 };
        let stamps: Vec<f64> = (0..480)
            .scan(0.0, |time, i| {
                *time += step(i);
                Some(*time)
            })
            .collect();
        let mut request = case.request();
        request.horizon = 1.0;
        let mut control = request.control.take().unwrap();
        control.loss = loss;
        request.control = Some(control.replaying(&stamps).unwrap());
        super::advise::advice(&request).unwrap()
    };
    for (block, loss, stands) in
        [(1, 0.0, true), (20, 0.0, true), (20, 0.05, true), (240, 0.0, true)]
    {
        let found = replayed(block, loss);
        let together = &found.looped.as_ref().unwrap().together;
        assert_eq!(together.growth < 0.0, stands, "{block}: {together:?}");
        let simulated = together.simulated.unwrap_or_else(|| panic!("{block}: {together:?}"));
        assert!(simulated.agrees(), "{block} {loss}: {simulated:?}");
        assert_eq!(found.holds(), stands, "{block}: {}", found.answer);
    }
}
