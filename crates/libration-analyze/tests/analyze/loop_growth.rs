//! Tests of the growth of loops with losses against an independent NumPy program.

use libration::catalog;
use libration::control::{Feedback, Jitter};
use libration_analyze::{Criteria, LatencyOption, LoopGrowth, Request, Stepping, Timing, analyze};
use libration_settings::equations::EquationSystem;
use serde_json::Value;

/// A case of `../reference/loops.json`, which `tools/loop_reference.py` made.
fn request(case: &Value) -> Request {
    let number = |value: &Value| value.as_f64().unwrap();
    let parameters = case["parameters"].as_object().unwrap().iter();
    let parameters: Vec<(&str, f64)> =
        parameters.map(|(name, value)| (name.as_str(), number(value))).collect();
    let built = catalog::build(case["system"].as_str().unwrap(), &parameters).unwrap();
    let rest = Some(&[0.0][..]);
    let jitter = case["jitter"].as_array().map(|law| {
        let rms = number(&law[1]);
        match law[0].as_str().unwrap() {
            "gaussian" => Jitter::Gaussian(rms),
            _ => Jitter::Uniform(rms),
        }
    });
    let gains = &case["feedback"];
    let timing = Timing {
        feedback: Some(Feedback { position: number(&gains[0]), velocity: number(&gains[1]) }),
        latency: Some(LatencyOption::Steps(number(&case["latency_steps"]))),
        jitter,
        loss: Some(number(&case["loss"])),
        ..Timing::default()
    };
    Request {
        system: EquationSystem::of_catalogue(built, rest, rest).unwrap(),
        stepping: Stepping::from_name(case["integrator"].as_str().unwrap()).unwrap(),
        dt: number(&case["dt"]),
        steps: 1,
        criteria: Criteria::default(),
        timing,
    }
}

fn growth(request: &Request) -> Option<LoopGrowth> {
    analyze(request).unwrap().timing.unwrap().growth
}

#[test]
fn second_moments_of_loops_with_losses_grow_as_numpy_says() {
    let reference: Value = serde_json::from_str(include_str!("../reference/loops.json")).unwrap();
    let cases = reference["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 18);
    for case in cases {
        let wanted = case["mean_square_radius"].as_f64().unwrap();
        let found = growth(&request(case)).unwrap();
        let radius = found.mean_square_radius.unwrap();
        // Matrices of up to 49 rows, of which each sum rounds 49 times: 49²·2⁻⁵³ is 3·10⁻¹³, which the condition of the
        // eigenvalue magnifies, by less than a thousand in every case of the program. Of a symmetric operator with fewer rows a
        // hundredth of that is met.
        assert!((radius / wanted - 1.0).abs() < 3e-12, "{radius} {wanted} {case}");
        let off = found.mean_square_growth.unwrap() - (wanted - 1.0);
        assert!(off.abs() < 3e-12, "{off} {case}");
    }
}

#[test]
fn growth_is_told_wherever_steps_or_losses_are_drawn_and_a_typical_run_only_where_it_is_known() {
    let reference: Value = serde_json::from_str(include_str!("../reference/loops.json")).unwrap();
    let plain = Request {
        timing: Timing {
            latency: None,
            loss: None,
            jitter: None,
            ..request(&reference["cases"][1]).timing
        },
        ..request(&reference["cases"][1])
    };
    let with = |timing: Timing| growth(&Request { timing, ..plain.clone() });
    let timing = plain.timing;
    assert!(with(timing).is_none());
    let jitter = Some(Jitter::Uniform(0.1));
    let jittered = with(Timing { jitter, ..timing }).unwrap();
    assert!(jittered.lyapunov_exponent.is_some());
    // Nothing is lost: the same, also where that is stated.
    let none_lost = with(Timing { jitter, loss: Some(0.0), ..timing }).unwrap();
    assert_eq!(none_lost.mean_square_radius, jittered.mean_square_radius);
    assert_eq!(none_lost.lyapunov_exponent, jittered.lyapunov_exponent);
    // What is lost acts, and the exponent of the loop without losses is not that of this one.
    let lossy = with(Timing { jitter, loss: Some(0.4), ..timing }).unwrap();
    assert!(lossy.mean_square_radius.unwrap() > jittered.mean_square_radius.unwrap() + 1e-3);
    assert_eq!(lossy.lyapunov_exponent, None);
    // Even steps of which none is lost: one matrix, whose second moments grow by the square of its radius.
    let even = with(Timing { loss: Some(0.0), ..timing }).unwrap();
    let analysis = analyze(&plain).unwrap();
    let radius = analysis.timing.unwrap().closed_loop_spectral_radius.unwrap();
    assert!((even.mean_square_radius.unwrap() / radius.powi(2) - 1.0).abs() < 1e-15);
    assert!((even.lyapunov_exponent.unwrap() - radius.ln()).abs() < 1e-15);
    // The step of the plant is what it is without feedback.
    let [re, im] = analysis.matrix.as_ref().unwrap().eigenvalues[0];
    assert!(
        (analysis.matrix.as_ref().unwrap().spectral_radius - re.hypot(im)).abs() < 1e-15
            && radius < 0.97,
        "{radius}"
    );
}
