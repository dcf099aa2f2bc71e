//! Oscillators that are recognised by their equations, and systems that look like one.

use libration_analyze::{Analysis, AnalyzeError, Criteria, Request, Stepping, Timing, analyze};
use libration_report::verdict::Outcome;
use libration_settings::equations::EquationSystem;

use super::verdicts::{examined, force, system};

/// One coordinate from 0.5, with an energy.
fn spring(acceleration: &str, energy: &str) -> EquationSystem {
    system(&format!(
        "coordinates = [\"q\"]\nparameters = {{ k = 20, m = 2 }}\nacceleration.q = \"{acceleration}\"\nenergy = \"{energy}\"\nstart = {{ q = 0.5 }}\n"
    ))
}

fn with_drift(system: EquationSystem) -> Result<Analysis, AnalyzeError> {
    let criteria = Criteria { max_drift: Some(1e-3), ..Criteria::default() };
    let stepping = Stepping::from_name("velocity-verlet").unwrap();
    let timing = Timing::default();
    analyze(&Request { system, stepping, dt: 0.01, steps: 1000, criteria, timing })
}

#[test]
fn an_oscillator_has_its_windows_and_its_criteria_however_it_is_written() {
    for (acceleration, energy) in [
        ("-k/m*q", "q'^2/2 + k/m*q^2/2"),
        ("-(k*q)/m", "m*q'^2/2 + k*q^2/2"),
        ("-10*q", "7*(q'^2 + 10*q^2)"),
    ] {
        let found = with_drift(spring(acceleration, energy)).unwrap();
        let [from, to] = found.stability_windows.unwrap()[0];
        // 2/ω of velocity Verlet.
        assert!(from == Some(0.0) && (to.unwrap() - 2.0 / 10.0_f64.sqrt()).abs() < 1e-15);
        // z²/4 of the start is the largest drift from rest.
        let largest = found.largest_dt.unwrap().energy_drift.unwrap().unwrap();
        // The root of an exact polynomial, times the rounded unit 1/ω.
        let wanted = (4e-3 / 10.0_f64).sqrt();
        assert!((largest / wanted - 1.0).abs() < 1e-12, "{acceleration}: {largest}");
        assert!(found.drift.is_some());
    }
}

#[test]
fn criteria_are_refused_and_no_drift_is_exact_where_energy_and_force_are_not_those_of_one_spring() {
    for (acceleration, energy) in [
        // An equilibrium beside the origin, energies of other springs, and a motion that grows.
        ("-10*q + 5", "q'^2/2 + 10*q^2/2 - 5*q"),
        ("-10*q", "q'^2/2 + 7*q^2/2"),
        ("-10*q", "q'^2 - 5*q^2"),
        ("-10*q", "q'^2/2 + 5*q^2 + q^4"),
        ("10*q", "q'^2/2 - 10*q^2/2"),
    ] {
        let refused = with_drift(spring(acceleration, energy));
        assert!(matches!(refused, Err(AnalyzeError::Criterion { .. })), "{acceleration} {energy}");
        let found = examined(&spring(acceleration, energy), "velocity-verlet", 0.01, 1000);
        assert!(found.drift.is_none(), "{acceleration} {energy}");
        assert!(found.motion.unwrap().energy.is_some());
    }
}

#[test]
fn systems_whose_exact_motions_grow_have_no_window_of_decay() {
    for acceleration in ["10*q0", "-10*q0 + 0.2*q0'"] {
        let found = examined(&force(acceleration), "rk4", 0.1, 100);
        assert!(found.stability_windows.is_none(), "{acceleration}");
    }
}

#[test]
fn a_damped_step_without_digits_for_its_decay_is_not_called_unstable() {
    let damped = force("-10*q0 - 0.2*q0'");
    let stepping = Stepping::Exact;
    let (criteria, timing) = (Criteria::default(), Timing::default());
    let request = Request { system: damped, stepping, dt: 1e-300, steps: 10, criteria, timing };
    let found = analyze(&request).unwrap();
    assert_eq!(found.verdicts.step.unwrap().outcome, Outcome::Unknown);
}

#[test]
fn a_start_without_a_force_is_refused_for_equations_as_for_names() {
    for acceleration in ["-1/q^2", "-1/sqrt(q*q)^3*q"] {
        let mut moved = spring(acceleration, "q'^2/2 - 1/q");
        moved.begin_at(Some(&[0.0]), None, &[]).unwrap();
        let (criteria, timing) = (Criteria::default(), Timing::default());
        let stepping = Stepping::from_name("rk4").unwrap();
        let request = Request { system: moved, stepping, dt: 0.1, steps: 10, criteria, timing };
        let refused = analyze(&request);
        assert!(matches!(refused, Err(AnalyzeError::Singular { .. })), "{acceleration}");
    }
}

#[test]
fn a_step_that_overflows_every_number_has_an_answer() {
    for acceleration in ["-10*q0", "-10*q0 - 0.2*q0'"] {
        let found = examined(&force(acceleration), "rk4", 1.7e308, 10);
        let step = found.verdicts.step.unwrap();
        assert_eq!(step.outcome, Outcome::Unstable, "{step}");
    }
}

#[test]
fn an_energy_without_a_value_is_named_with_the_first_step_that_has_none() {
    // cos √10 t falls below zero after 0.4967 s, in the fifth step of 0.1 s.
    let text = "coordinates = [\"q\"]\nacceleration.q = \"-10*q\"\nenergy = \"log(q)\"\nstart = { q = 1.0 }\n";
    let found = examined(&system(text), "rk4", 0.1, 300);
    assert_eq!(found.motion.unwrap().energy.unwrap().largest_at_step, 5);
}
