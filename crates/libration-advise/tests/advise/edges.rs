//! Tests of edge cases: long queues, fast clocks, command limits, rare outbursts, tolerances that no step meets.

use libration::AnySystem;
use libration::control::controller::PidGains;
use libration::control::{Feedback, Jitter};
use libration::system::{DampedOscillator, Kepler, Pendulum};
use libration_advise as advise;
use libration_advise::{Control, Imperfection, Law, Measure, Request};

use super::case::{Case, at_start};
use super::requests::{advice, with_work};
use super::steps::free;

const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };

fn request(period: f64, change: impl FnOnce(&mut Control)) -> Request {
    let mut request = Case { omega2: 10.0, gains: GAINS, period }.request();
    request.horizon = 1.0;
    if let Some(control) = &mut request.control {
        change(control);
    }
    request
}

#[test]
fn what_was_not_tried_is_not_said_to_stand() {
    // At 0.158 s it is unstable with its latency alone: 2.1 times as much as 0.075 s, of which a queue of 100 commands shows 1.3.
    let late = request(0.001, |control| {
        (control.latency, control.jitter) = (0.075, Jitter::Gaussian(0.05));
    });
    let found = advice(&late).unwrap();
    let combined = &found.looped.as_ref().unwrap().combined;
    let tried = combined.margin_tried_up_to.unwrap();
    assert!(combined.margin.is_none() && tried > 1.1 && tried < 2.1, "{combined:?}");
    assert!(found.answer.contains("at least"), "{}", found.answer);
}

#[test]
fn a_budget_of_latency_reaches_what_is_stated() {
    let late = request(0.001, |control| control.latency = 0.09);
    let found = advice(&late).unwrap();
    let looped = found.looped.as_ref().unwrap();
    // Of exact steps, by a program that knows nothing of this one: stable at 157 periods and not at 158.
    let limit = looped.budgets[0].stable_up_to.unwrap();
    assert!((0.157..0.158).contains(&limit) && found.holds(), "{limit}");
}

#[test]
fn a_fast_clock_makes_no_command_arrive_sooner() {
    // 0.2 s are unstable at either pace: 20 periods of 10 ms, or 36 of 5.5 ms.
    for skew in [0.0, -0.45] {
        let fast = request(0.01, |control| (control.latency, control.skew) = (0.2, skew));
        let found = advice(&fast).unwrap();
        assert!(found.looped.as_ref().unwrap().combined.growth > 0.0, "{}", found.answer);
        assert!(!found.holds());
    }
}

#[test]
fn noise_that_a_limit_would_feel_is_no_contradiction() {
    let gains = PidGains {
        proportional: 10.0,
        integral: 5.0,
        derivative: 2.0,
        filter: 0.0,
        most: 1.0,
        tracking: 1.0,
        target: [0.0],
    };
    let weak = request(0.01, |control| {
        (control.law, control.latency, control.deviation) = (Law::Pid(gains), 0.01, 0.02);
    });
    let found = advice(&weak).unwrap();
    let combined = &found.looped.as_ref().unwrap().combined;
    assert_eq!(combined.region_of_attraction.unwrap().returned, [8, 8]);
    assert!(combined.simulated.unwrap().agrees() && found.holds(), "{combined:?}");
}

#[test]
fn rare_outbursts_are_told_and_no_contradiction() {
    // The limit of losses is 0.7032.
    let lossy = request(0.05, |control| control.loss = 0.68);
    let found = advice(&lossy).unwrap();
    let simulated = found.looped.as_ref().unwrap().combined.simulated.unwrap();
    assert!(simulated.outbursts && simulated.agrees(), "{simulated:?}");
    assert!(found.warnings.iter().any(|text| text.contains("rare outbursts")));
    assert!(found.holds(), "{}", found.answer);
}

#[test]
fn what_is_lost_on_a_long_way_is_not_said_to_be_simulated() {
    let mut far = request(0.001, |control| (control.latency, control.loss) = (0.05, 0.01));
    far.system = at_start(AnySystem::Pendulum(Pendulum { omega2: 9.81 }), &[0.5], &[0.0]);
    let found = advice(&far).unwrap();
    let combined = &found.looped.as_ref().unwrap().combined;
    assert!(
        combined.simulated.is_none() && combined.region_of_attraction.is_none(),
        "{combined:?}"
    );
    assert!(found.warnings[0].contains("too long for losses"), "{:?}", found.warnings);
    assert!(found.holds(), "{}", found.answer);
}

#[test]
fn the_best_that_is_possible_is_met_when_it_is_asked_for() {
    let orbit = |most| {
        let kepler = AnySystem::Kepler(Kepler { mu: 1.0 });
        free(kepler, &[1.0, 0.0], &[0.0, 1.1], Measure::Energy, most, 0.1)
    };
    let none = advice(&orbit(1e-17)).unwrap();
    let best = none.integrators.iter().map(|choice| choice.lost).fold(f64::INFINITY, f64::min);
    assert!(none.chosen().is_none() && best > 1e-17 && best < 1e-13, "{best}");
    let choice = none.integrators.iter().find(|choice| choice.lost == best).unwrap();
    assert!(none.warnings[0].contains(&format!("{:.4e} s", choice.best_dt.unwrap())));
    // Of that step, which is one of those that are tried.
    assert!(advice(&orbit(2.0 * best)).unwrap().chosen().is_some());
}

#[test]
fn a_horizon_that_cannot_be_searched_is_refused() {
    let orbit = AnySystem::Kepler(Kepler { mu: 1.0 });
    let long = free(orbit, &[1.0, 0.0], &[0.0, 1.0], Measure::Trajectory, 1e-3, 1e7);
    assert!(advice(&long).unwrap_err().to_string().contains("choose a shorter horizon"));
    let pendulum = AnySystem::Pendulum(Pendulum { omega2: 9.81 });
    let long = free(pendulum, &[1.0], &[0.0], Measure::Trajectory, 1e-3, 1e7);
    assert!(advice(&long).unwrap_err().to_string().contains("choose a shorter horizon"));
}

#[test]
fn an_even_record_is_an_even_clock() {
    let stamps: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.01).collect();
    let even =
        request(0.01, |control| *control = control.clone().with_time_stamps(&stamps).unwrap());
    assert!(even.control.as_ref().unwrap().record.is_none());
    let jitter = &advice(&even).unwrap().looped.unwrap().budgets[1];
    assert!(jitter.kind == Imperfection::Jitter && jitter.stated == 0.0);
}

#[test]
fn a_cost_that_is_infinite_is_no_fault_of_integrators() {
    let mut late = request(0.01, |control| control.latency = 0.3);
    (late.tolerance.of, late.tolerance.most) = (Measure::Cost, 0.1);
    let found = advice(&late).unwrap();
    assert!(
        found.answer.contains("unstable with the stated imperfections")
            && !found.answer.contains("No integrator")
    );
    assert!(found.integrators.is_empty() && !found.holds());
    // And where nothing can be said of all together, but of its latency.
    let longer = request(0.001, |control| {
        (control.latency, control.jitter) = (0.2, Jitter::Gaussian(0.1));
    });
    assert!(advice(&longer).unwrap_err().to_string().contains("unstable with its latency"));
}

#[test]
fn a_narrow_window_of_instability_ends_a_budget_of_latency() {
    // Damped, and fed back so weakly that it is unstable for some milliseconds of latency, and stable again up to 3.7 s.
    let mut weak = request(0.4, |control| {
        control.law = Law::Pd(Feedback { position: 0.0, velocity: -0.214 });
        control.latency = 1.7;
    });
    let damped = AnySystem::DampedOscillator(DampedOscillator { omega2: 10.0, gamma: 0.2 });
    weak.system = at_start(damped, &[0.0], &[0.0]);
    let limit = |request: &Request| {
        let budgets = with_work(|work| advise::budgets(work, request)).unwrap();
        budgets[0].stable_up_to.unwrap()
    };
    let short = limit(&weak);
    assert!((1.77..1.788).contains(&short), "{short}");
    weak.control.as_mut().unwrap().latency = 1.788;
    assert_eq!(limit(&weak), short);
}

#[test]
fn a_search_that_ends_before_its_steps_are_short_enough_says_so() {
    let kepler = AnySystem::Kepler(Kepler { mu: 1.0 });
    let long = free(kepler, &[1.0, 0.0], &[0.0, 1.0], Measure::Phase, 1e-3, 1e7);
    assert!(advice(&long).unwrap_err().to_string().contains("one degree of freedom"));
    let pendulum = AnySystem::Pendulum(Pendulum { omega2: 9.81 });
    let long = free(pendulum, &[1.0], &[0.0], Measure::Phase, 1e-3, 1e6);
    let found = advice(&long).unwrap();
    assert!(found.tried_down_to.is_some() && found.chosen().is_none());
    assert!(found.answer.contains("shorter ones were not tried"), "{}", found.answer);
}
