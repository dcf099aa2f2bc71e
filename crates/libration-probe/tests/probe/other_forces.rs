//! Verdicts on gains where more acts than the servos whose gains are changed.

use libration_probe::{GainReport, OtherForces, gains_page};
use libration_report::verdict::Outcome;

use crate::measured_gains::{DT, Sliders, measured};

/// A slider on a spring with a servo of 100 N/m.
fn slider(spring: f64) -> GainReport {
    measured(Sliders::new(&[spring], &[100.0], &[3.0]), DT)
}

/// A slider on a spring with a motor: the simulator has no servo.
fn without_servos(spring: f64) -> GainReport {
    let mut found = slider(spring);
    let measured = found.measured.as_mut().unwrap();
    measured.servos.clear();
    measured.largest_factor = f64::NAN;
    let measured = found.measured.take().unwrap();
    found.with_measured(measured)
}

fn names(all: &[&str]) -> Vec<String> {
    all.iter().map(|name| (*name).to_owned()).collect()
}

#[test]
fn a_step_that_does_not_grow_is_unknown_where_an_actuator_has_another_effect_at_each_command() {
    let damper = || OtherForces {
        actuators: names(&["damper"]),
        commanded: names(&["damper"]),
        ..OtherForces::default()
    };
    assert_eq!(slider(0.0).verdict.outcome, Outcome::Stable);
    let found = slider(0.0).with_other_forces(damper());
    assert_eq!(found.verdict.outcome, Outcome::Unknown);
    assert!(found.answer.contains("the effect of `damper` on the motion changes with the command"));
    assert!(found.largest_factor.is_nan() && found.measured.as_ref().unwrap().servos.is_empty());
    assert_eq!(found.verdict.not_examined.last().unwrap(), "other gains of `damper`");
    assert!(gains_page(&found).contains("Examine the servos in a model without"));
    // 4 m/h² is 8·10⁴ N/m: growth at the commands of the point is growth, but not that without any servo.
    let found = slider(1e5).with_other_forces(damper());
    assert_eq!(found.verdict.outcome, Outcome::Unstable);
    assert!(!found.answer.contains("without any servo"), "{}", found.answer);
    assert!(found.answer.starts_with("The step is unstable without gains of the servos, with other actuators as they are (`damper`)"));
    assert!(found.answer.contains("this is that of the point"), "{}", found.answer);
    assert!(gains_page(&found).contains("The step is unstable without gains of the servos"));
}

#[test]
fn a_step_without_gains_has_no_gains_that_hold() {
    let none = || OtherForces { without_gains: true, ..OtherForces::default() };
    let found = without_servos(0.0).with_other_forces(none());
    assert_eq!(found.verdict.outcome, Outcome::Unknown);
    assert!(found.answer.contains("no actuator is a servo with gains"), "{}", found.answer);
    assert!(!found.answer.contains("no larger gain"), "{}", found.answer);
    let found = without_servos(1e5).with_other_forces(none());
    assert_eq!(found.verdict.outcome, Outcome::Unstable);
    assert!(found.answer.starts_with("The step is unstable without any servo"), "{}", found.answer);
    let damper = OtherForces { actuators: names(&["damper"]), ..none() };
    let found = without_servos(1e5).with_other_forces(damper);
    assert!(
        found.answer.starts_with("The step is unstable with its actuators as they are (`damper`)")
    );
    assert!(!found.answer.contains("hold them") && !gains_page(&found).contains("any servo"));
}

#[test]
fn friction_that_is_not_in_the_step_is_named_in_the_verdict_and_the_answer() {
    let friction =
        || OtherForces { friction: names(&["joint `a`", "tendon `t`"]), ..OtherForces::default() };
    for (spring, outcome) in [(0.0, Outcome::Stable), (1e5, Outcome::Unstable)] {
        let found = slider(spring).with_other_forces(friction());
        assert_eq!(found.verdict.outcome, outcome);
        assert!(found.verdict.evidence.ends_with(", without friction loss"), "{}", found.verdict);
        assert_eq!(found.verdict.not_examined, ["friction loss of joint `a`, tendon `t`"]);
        assert!(found.answer.contains("This is without friction loss"), "{}", found.answer);
    }
    let sticks = "while friction loss holds, a mode grows by a factor 8 per step";
    let undecided = || OtherForces { undecided: names(&[sticks]), ..friction() };
    let found = slider(0.0).with_other_forces(undecided());
    assert_eq!(
        (found.verdict.outcome, found.verdict.evidence.as_str()),
        (Outcome::Unknown, sticks)
    );
    assert_eq!(slider(1e5).with_other_forces(undecided()).verdict.outcome, Outcome::Unstable);
}
