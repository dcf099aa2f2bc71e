//! Words and pages of gains beside closed forms.

use libration_probe::OtherForces;
use libration_report::verdict::Outcome;

use crate::gains::report;

#[test]
fn factors_of_held_torques_are_those_of_a_step_beside_an_exact_one_of_the_same_length() {
    let servos = r#"{"mass": [1], "kp": [100], "kv": [2], "torque": "held"}"#;
    let found = report(servos, 0.01, 4, "symplectic-euler");
    // ζ ω dt = 0.1 · 10 · 0.01.
    let exact = (-0.01_f64).exp();
    let part = format!("largest factor of a mode in 0.01 s; {exact:.5} in exact steps");
    let page = libration_probe::gains_page(&found);
    assert!(page.contains(&part) && page.contains("h is the length of a step, through which"));
    // With torques in each substep both are of a substep.
    let found = report(&servos.replace("held", "each-substep"), 0.01, 4, "symplectic-euler");
    let exact = (-0.0025_f64).exp();
    let part = format!("largest factor of a mode in 0.0025 s; {exact:.4} in exact steps");
    let page = libration_probe::gains_page(&found);
    assert!(page.contains(&part) && page.contains("h is the length of a substep"), "{part}");
}

#[test]
fn factors_without_a_stable_one_are_said_not_to_hold() {
    // An explicit step of an undamped oscillator grows with each gain.
    let found = report(r#"{"mass": [1], "kp": [100]}"#, 0.01, 1, "explicit-euler");
    assert!(!found.holds && found.largest_factor == 0.0);
    let part = "no tried factor of all gains of position makes them hold.";
    assert!(found.answer.contains(part), "{}", found.answer);
    let found = report(r#"{"mass": [1], "kp": [100]}"#, 0.01, 1, "backward-euler");
    assert!(found.answer.contains("no larger gain of position was found that does not hold."));
}

#[test]
fn without_gains_of_position_nothing_is_said_of_larger_ones_and_without_any_gain_nothing_holds() {
    let found =
        report(r#"{"mass": [1, 1], "kp": [0, 0], "kv": [1, 1]}"#, 0.01, 1, "symplectic-euler");
    assert!(found.holds && !found.answer.contains("larger gain of position"), "{}", found.answer);
    // 4/h² − 2 kv/h.
    assert!((found.joints[0].largest_kp / 39_800.0 - 1.0).abs() < 1e-6);
    let none = report(r#"{"mass": [1], "kp": [0]}"#, 0.01, 1, "symplectic-euler");
    let none = none.with_other_forces(OtherForces::default());
    assert!(!none.holds && none.answer.contains("there are no gains"), "{}", none.answer);
    // A spring of 5·10⁴ N/m is beyond 4/h² without any gain.
    let text = r#"{"mass": [1], "kp": [0], "stiffness": [5e4]}"#;
    assert_eq!(report(text, 0.01, 1, "symplectic-euler").verdict.outcome, Outcome::Unstable);
}
