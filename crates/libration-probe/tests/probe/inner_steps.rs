//! Inner steps of a fixed length have no limit of small steps: they are named, and no rate of a system is shown.

use libration_probe::Subject;
use libration_report::verdict::Outcome;

use crate::simulators::{Simulator, kinds};

const INNER: f64 = 0.01;

fn decay(x: &[f64], count: f64, h: f64) -> Vec<f64> {
    (0..count as usize).fold(x.to_vec(), |x, _| vec![x[0] * (1.0 - h)])
}

/// `ẋ = −x`.
fn subject(dt: f64) -> Subject {
    Subject::new("decay", vec![0.0], vec![], dt)
}

#[test]
fn a_fixed_inner_step_is_named_and_leaves_the_system_unknown() {
    type Count = fn(f64) -> f64;
    let counts: [(Count, &str); 5] = [
        (|parts| (parts + 1e-9).floor(), "changes nothing"),
        (|parts| parts.round(), "changes nothing"),
        (|parts| parts.round().max(1.0), "by the same amount"),
        (|parts| (parts - 1e-9).ceil(), "by the same amount"),
        // A length that is rounded to the inner step and used as it is.
        (|parts| parts.floor().max(1.0), "by the same amount"),
    ];
    for (count, text) in counts {
        // Also steps of 64 inner ones, whose halves are whole numbers of them down to a sixty-fourth.
        for dt in [0.01, 0.05, 0.64, 0.1] {
            let report =
                Simulator::new(|x, _, dt| decay(x, count(dt / INNER), INNER)).audit(&subject(dt));
            assert_eq!(kinds(&report), ["fixed-inner-step"], "{dt} {}", report.answer);
            assert!(report.findings[0].text.contains(text), "{:?}", report.findings);
            assert!(report.flow.is_none() && report.largest_dt.is_none() && report.order.is_none());
            assert!(report.modes.iter().all(|mode| mode.flow.is_none()));
            assert_eq!(report.verdict.outcome, Outcome::NoFault);
            assert!(
                report.answer.contains("Not examined: modes of the system"),
                "{}",
                report.answer
            );
            // The longest step that is no longer than an inner one, by halvings of dt.
            let longest = report.inner_step.unwrap().longest_dt;
            assert!((0.2 * INNER..2.0 * INNER).contains(&longest), "{longest}");
        }
    }
}

#[test]
fn a_step_shorter_than_the_inner_one_that_does_nothing_is_named() {
    let report = Simulator::new(|x, _, dt| decay(x, (dt / INNER + 1e-9).floor(), INNER))
        .audit(&subject(0.004));
    assert_eq!(kinds(&report), ["fixed-inner-step"], "{}", report.answer);
}

#[test]
fn an_inner_step_that_grows_is_no_good_verdict() {
    // An oscillator of ω = 3 by explicit Euler.
    let step = |x: &[f64], _: &[f64], dt: f64| {
        let count = (dt / INNER + 1e-9).floor() as usize;
        (0..count).fold(x.to_vec(), |x, _| vec![x[0] + INNER * x[1], x[1] - INNER * 9.0 * x[0]])
    };
    let report =
        Simulator::new(step).audit(&Subject::new("oscillator", vec![0.0, 0.0], vec![], 0.05));
    assert_eq!(report.verdict.outcome, Outcome::Unknown, "{}", report.answer);
    assert!(kinds(&report).contains(&"fixed-inner-step"));
}

#[test]
fn inner_steps_that_follow_the_length_are_no_finding() {
    // Equal parts, and a remainder.
    let parts = |x: &[f64], _: &[f64], dt: f64| {
        let count = (dt / INNER - 1e-9).ceil();
        decay(x, count, dt / count)
    };
    let remainder = |x: &[f64], _: &[f64], dt: f64| {
        let mut x = x.to_vec();
        let mut left = dt;
        while left > 0.0 {
            let h = left.min(INNER);
            x[0] *= 1.0 - h;
            left -= h;
        }
        x
    };
    for dt in [0.004, 0.05, 0.64] {
        for report in [
            Simulator::new(parts).audit(&subject(dt)),
            Simulator::new(remainder).audit(&subject(dt)),
        ] {
            assert_eq!(kinds(&report), [""; 0], "{dt} {}", report.answer);
            let rate = report.modes[0].flow.unwrap().growth_rate;
            // That of the inner step is −1.005.
            assert!((rate + 1.0).abs() < 1e-5, "{dt} {rate}");
        }
    }
}

#[test]
fn a_limit_that_a_state_reaches_is_no_inner_step() {
    // A speed that is clipped at the displaced start on one side.
    let step = |x: &[f64], _: &[f64], dt: f64| {
        let v = (x[1] - dt * (9.0 * x[0] + 0.3 * x[1])).min(0.03);
        vec![x[0] + dt * v, v]
    };
    let report = Simulator::new(step).audit(&Subject::new("limit", vec![0.0, 0.0], vec![], 0.01));
    assert!(!kinds(&report).contains(&"fixed-inner-step"), "{}", report.answer);
}
