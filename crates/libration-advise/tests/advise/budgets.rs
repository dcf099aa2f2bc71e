//! Tests of budgets of loops against plain simulations, and against the mean over random steps.

use libration::State;
use libration::analysis::{ObserverNoise, Plant};
use libration::control::controller::{Luenberger, Pid, PidGains};
use libration::control::{Controller, Feedback, LqrWeights};
use libration::system::Oscillator;
use libration_advise as advise;
use libration_advise::{AdviseError, Budget, Correction, Imperfection, Law, Regulator};

use super::case::{Case, drawn};
use super::requests::with_work;

#[test]
fn of_twenty_random_loops_each_budget_ends_where_simulations_become_unstable() {
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
        let budgets = with_work(|work| advise::budgets(work, &case.request()));
        let budgets: Vec<Budget> = match budgets {
            Ok(budgets) => budgets,
            Err(AdviseError::Unstable { .. }) => {
                skipped += 1;
                assert!(case.growth(case.feedback(), 0.0, 0.0) > 0.0, "{case:?}");
                continue;
            }
            Err(error) => panic!("{case:?}: {error}"),
        };
        for (i, kind) in [Imperfection::Latency, Imperfection::Jitter, Imperfection::Skew]
            .into_iter()
            .enumerate()
        {
            let budget = budgets.iter().find(|budget| budget.kind == kind).unwrap();
            let Some(limit) = budget.stable_up_to else { continue };
            tried[i] += 1;
            let grows = |share: f64| match kind {
                Imperfection::Latency => case.growth(case.feedback(), share * limit, 0.0) > 0.0,
                Imperfection::Skew => case.growth(case.feedback(), 0.0, share * limit) > 0.0,
                _ => case.mean_square(share * limit) > 1.0,
            };
            for (share, stable) in [(0.98, true), (1.02, false)] {
                assert_eq!(!grows(share), stable, "{case:?}: {kind:?} {limit} {share}");
                let cost = case.cost(kind, share * limit);
                assert_eq!(cost.is_finite(), stable, "{case:?}: {kind:?} {limit} {share}: {cost}");
            }
        }
        loops += 1;
        if loops == 20 {
            break;
        }
    }
    // Late enough every loop fails, and slow enough most; of jitter many bear all that there is.
    assert!(tried[0] == 20 && tried[2] > 12 && tried[1] > 3, "{tried:?}, {skipped} unstable");
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
        let budgets = with_work(|work| advise::budgets(work, &request)).unwrap();
        [Imperfection::Latency, Imperfection::Skew].map(|kind| {
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
    let gains = Feedback { position: 0.0, velocity: 12.0 };
    let case = Case { omega2: 10.0, gains, period: 0.1 };
    // Long steps alone let velocities grow by 1.1 each, and short ones hardly bring back positions: blocks that are long enough
    // grow, though a law of that rms does not, nor do steps in turn.
    for (block, loss, stands) in
        [(1, 0.0, true), (20, 0.0, true), (20, 0.05, true), (240, 0.0, false)]
    {
        let long = |i: usize| (i / block).is_multiple_of(2);
        let steps: Vec<f64> = (0..480).map(|i| if long(i) { 1.75 } else { 0.25 }).collect();
        let stamps: Vec<f64> = std::iter::once(0.0)
            .chain(steps.iter().scan(0.0, |time, step| {
                *time += step * case.period;
                Some(*time)
            }))
            .collect();
        let mut request = case.request();
        request.horizon = 1.0;
        let mut control = request.control.take().unwrap();
        control.loss = loss;
        request.control = Some(control.with_time_stamps(&stamps).unwrap());
        let found = super::requests::advice(&request).unwrap();
        let combined = &found.looped.as_ref().unwrap().combined;
        assert_eq!(combined.growth < 0.0, stands, "{block}: {combined:?}");
        assert_eq!(found.holds(), stands, "{block}: {}", found.answer);
        match combined.simulated {
            Some(simulated) => assert!(simulated.agrees(), "{block} {loss}: {simulated:?}"),
            None => assert!(!stands, "{block}"),
        }
        if loss == 0.0 {
            let grown = case.growth_by(case.feedback(), &steps, 0.0);
            assert_eq!(grown < 0.0, stands, "{block}: {grown} {}", combined.growth);
        }
    }
}
