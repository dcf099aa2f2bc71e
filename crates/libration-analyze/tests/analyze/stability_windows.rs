//! Tests of stability windows of a damped oscillator against a NumPy scan.

use libration::analysis::{LinearStepper, StepLimits};
use libration::linear::{Matrix, eigenvalues};
use libration::{AnyMethod, AnySystem, Method};
use libration_analyze::{Request, Stepping, analyze};
use libration_report::verdict::Outcome;
use serde_json::Value;

use super::requests::{at, request};

#[test]
fn windows_of_damped_oscillators_are_those_that_numpy_finds() {
    let reference: Value = serde_json::from_str(include_str!("../reference/windows.json")).unwrap();
    let horizon = reference["horizon"].as_f64().unwrap();
    for case in reference["cases"].as_array().unwrap() {
        let number = |key: &str| case[key].as_f64().unwrap();
        let (omega2, gamma) = (number("omega2"), number("gamma"));
        let system =
            AnySystem::build("damped-oscillator", &[("omega2", omega2), ("gamma", gamma)]).unwrap();
        let method = Method::from_name(case["integrator"].as_str().unwrap()).unwrap();
        let system = at(system, &[1.0], &[0.0]);
        let asked =
            Request { system, ..request("damped-oscillator", method, 0.01, &[1.0], &[0.0]) };
        let found = analyze(&asked).unwrap().stability_windows.unwrap();
        let number = |end: &Option<f64>| end.unwrap();
        // Up to where the program looked.
        let found: Vec<[f64; 2]> =
            found.iter().map(|window| window.each_ref().map(number)).collect();
        let found: Vec<_> =
            found.into_iter().filter(|[from, _]| *from < horizon / omega2.sqrt()).collect();
        let wanted = case["windows"].as_array().unwrap();
        assert_eq!(found.len(), wanted.len(), "{found:?} {case}");
        for (found, wanted) in
            found.iter().flatten().zip(wanted.iter().flat_map(|w| w.as_array().unwrap()))
        {
            let wanted = wanted.as_f64().unwrap();
            // A part of 10⁻⁹ of the step changes the radius by 10⁻¹² or more, and LAPACK's is right to 2·10⁻¹⁴: the program
            // asserts the one, and rounding of entries below 30 is the other.
            assert!((found - wanted).abs() <= 2e-11 * wanted, "{found} {wanted} {case}");
        }
    }
}

/// Each step moves a free mass by `x₀ + v₀ h`, which is its exact motion, and so adds no growth at any step.
#[test]
fn each_step_of_a_free_mass_is_stable_at_any_length() {
    for (name, parameters) in [
        ("oscillator", &[("omega2", 0.0)][..]),
        ("damped-oscillator", &[("omega2", 0.0), ("gamma", 0.0)]),
    ] {
        let system = AnySystem::build(name, parameters).unwrap();
        for method in AnyMethod::all() {
            for dt in [1e-9, 0.1, 1e6] {
                let stepping = match method {
                    AnyMethod::Explicit(method) => Stepping::Method(method),
                    AnyMethod::Implicit(method) => Stepping::Implicit(method),
                };
                let system = at(system, &[1.0], &[1.0]);
                let asked =
                    Request { system, stepping, ..request(name, Method::Rk4, dt, &[1.0], &[1.0]) };
                let found = analyze(&asked).unwrap();
                assert_eq!(
                    found.matrix.as_ref().unwrap().update_matrix,
                    [[1.0, dt], [0.0, 1.0]],
                    "{method:?}"
                );
                assert_eq!(found.stability_windows, Some(vec![[Some(0.0), None]]), "{method:?}");
                let verdict = found.verdicts.step.unwrap();
                assert_eq!(verdict.outcome, Outcome::Stable, "{method:?}");
                assert!(verdict.evidence.contains("as those of exact steps do"), "{verdict}");
            }
        }
    }
    // With damping alone, symplectic Euler multiplies velocities by 1 − γh.
    let system = AnySystem::build("damped-oscillator", &[("omega2", 0.0), ("gamma", 2.0)]).unwrap();
    for (dt, wanted) in [(0.999, Outcome::Stable), (1.001, Outcome::Unstable)] {
        let step = request("damped-oscillator", Method::SymplecticEuler, dt, &[1.0], &[1.0]);
        let found = analyze(&Request { system: at(system, &[1.0], &[1.0]), ..step }).unwrap();
        assert_eq!(found.verdicts.step.unwrap().outcome, wanted, "{dt}");
        assert_eq!(found.stability_windows, Some(vec![[Some(0.0), Some(1.0)]]));
    }
}

#[test]
fn windows_are_known_for_any_damping_that_is_not_extreme() {
    for (omega2, gamma) in
        [(10.0, 1e-12), (1e-9, 0.3), (7.1e8, 0.123), (std::f64::consts::PI, 0.1), (0.1, 1e5)]
    {
        let system =
            AnySystem::build("damped-oscillator", &[("omega2", omega2), ("gamma", gamma)]).unwrap();
        let asked = Request {
            system: at(system, &[1.0], &[0.0]),
            ..request("damped-oscillator", Method::Suzuki4, 1e-7, &[1.0], &[0.0])
        };
        assert!(analyze(&asked).unwrap().stability_windows.is_some(), "{omega2} {gamma}");
    }
}

#[test]
fn textbook_verlet_is_said_to_be_another_method_where_forces_depend_on_velocities() {
    let note = |system: &str, parameters: &[(&str, f64)], method| {
        let system = AnySystem::build(system, parameters).unwrap();
        let (q, v) = if system.name() == "driven-oscillator" {
            (&[1.0, 0.0][..], &[0.0, 1.0][..])
        } else {
            (&[1.0][..], &[0.0][..])
        };
        let whole = at(system, q, v);
        analyze(&Request { system: whole, ..request(system.name(), method, 0.01, q, v) })
            .unwrap()
            .note
    };
    for system in ["damped-oscillator", "driven-oscillator"] {
        let told = note(system, &[], Method::TextbookVerlet).unwrap();
        assert!(told.contains("another method"), "{told}");
        let told = note(system, &[], Method::VelocityVerlet).unwrap_or_default();
        assert!(!told.contains("another method"), "{told}");
        let told = note(system, &[("gamma", 0.0)], Method::TextbookVerlet).unwrap_or_default();
        assert!(!told.contains("another method"), "{told}");
    }
    assert_eq!(note("oscillator", &[], Method::TextbookVerlet), None);
}

#[test]
fn searched_limits_of_long_steps_are_where_the_step_leaves_the_unit_circle() {
    let a = Matrix::from_rows(&[[0.0, 1.0], [-9.0, -0.4]]).unwrap();
    let (stepper, values) = (LinearStepper::new(&a).unwrap(), eigenvalues(&a).unwrap());
    for name in ["blanes-moan-s10-6-kdk", "blanes-moan-s6-4-dkd", "velocity-verlet"] {
        let method = Method::from_name(name).unwrap();
        let windows = StepLimits::searched(method).of(&stepper, &values).unwrap();
        assert!(windows[0].from == 0.0, "{name}: {windows:?}");
        let radius = |dt: f64| {
            let step = stepper.with_step::<f64>(method, dt).unwrap();
            let values = eigenvalues(&step.update_matrix()).unwrap();
            values.iter().map(|value| value.norm()).fold(0.0, f64::max)
        };
        // A multiplier leaves the circle at a rate of more than a tenth per relative change of the step.
        let end = windows[0].to;
        assert!(radius(end * (1.0 - 1e-6)) < 1.0 && radius(end * (1.0 + 1e-6)) > 1.0, "{name}");
    }
    // Short ones are exact.
    let verlet = StepLimits::searched(Method::VelocityVerlet).of(&stepper, &values);
    assert_eq!(verlet, stepper.stable_steps(Method::VelocityVerlet, &values));
}
