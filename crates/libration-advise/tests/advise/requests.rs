//! Tests of requests for advice.

use std::sync::atomic::AtomicBool;

use libration::AnySystem;
use libration::control::{Feedback, Jitter};
use libration::system::{Oscillator, Pendulum};
use libration_advise as advise;
use libration_advise::{Advice, AdviseError, Imperfection, Law, Measure, Request};
use libration_report::verdict::Outcome;
use libration_work::{Silent, Work};

use super::case::{Case, at_start};
use super::steps::free;

pub(crate) fn with_work<R>(work: impl FnOnce(&Work<'_>) -> R) -> R {
    let stop = AtomicBool::new(false);
    work(&Work::new(&Silent, &stop))
}

pub(crate) fn advice(request: &Request) -> Result<Advice, AdviseError> {
    with_work(|work| advise::advise(work, request))
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
    let simulated = looped.combined.simulated.unwrap();
    let off = (simulated.cost - simulated.predicted) / simulated.error;
    assert!(off.abs() < 3.0 && simulated.error < 0.02 * simulated.cost, "{simulated:?}");
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    // The latency is nearest to its limit, and swings there.
    let failing = looped.fails_first.as_ref().unwrap();
    assert_eq!(failing.kind, Imperfection::Latency);
    assert!((0.5..1.2).contains(&failing.frequency.unwrap()), "{failing:?}");
    // All of it together leaves less room than the worst alone.
    let room = looped.combined.margin.unwrap();
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
        let pendulum = AnySystem::Pendulum(Pendulum { omega2: 9.81 });
        request.system = at_start(pendulum, &[std::f64::consts::PI], &[0.0]);
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
    let returns = far.looped.unwrap().combined.region_of_attraction.unwrap();
    assert!(returns.up_to > 0.1 && returns.up_to < 1.0, "{returns:?}");
}

#[test]
fn a_loop_that_is_unstable_without_imperfections_has_an_answer_that_says_how() {
    let case =
        Case { omega2: 10.0, gains: Feedback { position: -20.0, velocity: 1.0 }, period: 0.02 };
    let answer = |case: Case| {
        let found = advice(&case.request()).unwrap();
        assert_eq!(found.verdict.outcome, Outcome::Unstable);
        found.answer
    };
    let growing = answer(case);
    assert!(
        growing.contains("unstable without") && growing.contains("without oscillation"),
        "{growing}"
    );
    let undamped = answer(Case { gains: Feedback { position: 10.0, velocity: -1.0 }, ..case });
    assert!(undamped.contains("it oscillates at 0.7"), "{undamped}");
}

#[test]
fn what_cannot_be_advised_on_is_refused_before_any_work() {
    let case =
        Case { omega2: 10.0, gains: Feedback { position: 10.0, velocity: 1.0 }, period: 0.02 };
    let told = |request: &Request| advice(request).unwrap_err().to_string();
    let mut energy = case.request();
    energy.tolerance.of = Measure::Energy;
    assert!(told(&energy).contains("a loop does not conserve it"), "{}", told(&energy));
    let oscillator = AnySystem::Oscillator(Oscillator { omega2: 10.0 });
    let cost = free(oscillator, &[1.0], &[0.0], Measure::Cost, 0.1, 10.0);
    assert!(told(&cost).contains("a cost requires a loop"));
    let rest = free(oscillator, &[0.0], &[0.0], Measure::Energy, 0.1, 10.0);
    assert!(told(&rest).contains("nothing moves from this start"));
    let still = free(oscillator, &[0.0], &[0.0], Measure::Trajectory, 0.1, 10.0);
    assert!(told(&still).contains("nothing moves from this start"));
    let mut several = case.request();
    several.system = at_start(oscillator, &[0.0; 3], &[0.0; 3]);
    assert!(told(&several).contains("3 degrees of freedom"));
}

#[test]
fn an_oscillator_has_the_steps_of_its_coordinates_in_any_dimension() {
    let oscillator = AnySystem::Oscillator(Oscillator { omega2: 10.0 });
    let steps = |dimension: usize| {
        let (q, v) = (vec![1.0; dimension], vec![0.0; dimension]);
        let found = advice(&free(oscillator, &q, &v, Measure::Energy, 1e-3, 3.0)).unwrap();
        let of = |name| found.integrators.iter().find(|choice| choice.integrator == name);
        ["velocity-verlet", "rk4"].map(|name| of(name).unwrap().dt.unwrap())
    };
    // Coordinates from equal starts have equal relative errors. The mean kinetic energy is that of steps of 0.05 rad of the fastest rate,
    // which the norm of three equal derivatives overestimates, and a search ends within 0.2 %.
    for (one, three) in steps(1).into_iter().zip(steps(3)) {
        assert!((three / one - 1.0).abs() < 0.01, "{one} {three}");
    }
}

#[test]
fn requests_of_the_examples_are_valid() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let requests: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    assert_eq!(requests.len(), 3);
    for path in requests {
        let text = std::fs::read_to_string(&path).unwrap();
        if let Err(error) = advise::parse(&text, "request.toml") {
            panic!("{}: {error}", path.display());
        }
    }
}
