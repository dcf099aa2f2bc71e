//! Tests of analyses of linear plants against a NumPy program, `tools/linear_analysis_reference.py`.

use std::sync::atomic::AtomicBool;

use libration::control::Latency;
use libration::linear::{
    DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix, log_spectral_radius,
};
use libration_analyze::Stepping;
use libration_analyze::linear_analysis::{
    LinearAnalysis, LinearAnalysisError, LinearRequest, StepAnalysis, analyze,
};
use libration_report::verdict::Outcome;
use serde_json::Value;

fn cases() -> Vec<Value> {
    serde_json::from_str(include_str!("../reference/linear_analysis.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

fn matrix(value: &Value) -> Matrix {
    Matrix::from_rows(&rows(value)).unwrap()
}

fn plant(case: &Value) -> LinearPlant {
    let (a, b) = (matrix(&case["a"]), matrix(&case["b"]));
    let n = a.rows();
    LinearPlant::new(a, b, Matrix::identity(n), Matrix::zeros(n, 1)).unwrap()
}

/// The request for a plant with a gain of zero.
fn open(plant: LinearPlant, dt: Option<f64>) -> LinearRequest {
    let (n, m, p) = (plant.states.len(), plant.inputs.len(), plant.outputs.len());
    let controller = DiscreteController::gain(Matrix::zeros(m, p));
    let period = plant.sampling_period.unwrap_or(0.01);
    let cost = Matrix::identity(n + m);
    let linear = LinearLoop::new(plant, controller, period, cost, vec![0.0; p]).unwrap();
    LinearRequest {
        linear,
        timing: None,
        dt,
        integrator: None,
        operating_point: None,
        is_linearised: false,
        system: None,
        note: None,
    }
}

fn run(request: &LinearRequest) -> LinearAnalysis {
    analyze(request, &AtomicBool::new(false)).unwrap()
}

fn step<'a>(analysis: &'a LinearAnalysis, name: &str) -> &'a StepAnalysis {
    analysis.steps.iter().find(|step| step.integrator == name).unwrap()
}

#[test]
fn modes_and_multipliers_of_each_integrator_are_those_of_numpy() {
    for case in cases() {
        let dt = case["dt"].as_f64().unwrap();
        let analysis = run(&open(plant(&case), Some(dt)));
        let wanted = rows(&case["eigenvalues"]);
        let size = analysis.fastest_rate;
        for (mode, wanted) in analysis.modes.iter().zip(&wanted) {
            for (found, wanted) in mode.eigenvalue.iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-12 * size, "{mode:?} {wanted}");
            }
        }
        let of_steps = case["steps"].as_object().unwrap();
        assert_eq!(analysis.steps.len(), of_steps.len());
        for (name, wanted) in of_steps {
            let found = step(&analysis, name);
            let radius = wanted["spectral_radius"].as_f64().unwrap();
            for found in [found.predicted_spectral_radius, found.spectral_radius] {
                let found = found.unwrap();
                assert!((found / radius - 1.0).abs() < 1e-12, "{name} {found} {radius}");
            }
            if let (Some(double), Some(single)) = (found.simulated, found.simulated_f32) {
                assert!((double.growth / radius - 1.0).abs() < 1e-12, "{name} {double:?} {radius}");
                // Each operation rounds by 2⁻²⁴, and a step has some ten for each of six states.
                assert!((single.growth / radius - 1.0).abs() < 4e-6, "{name} {single:?} {radius}");
            }
            for (mode, wanted) in found.modes.iter().zip(rows(&wanted["multipliers"])) {
                let [re, im] = wanted[..] else { panic!() };
                let (growth, angle) = (re.hypot(im), im.atan2(re));
                assert!((mode.growth / growth - 1.0).abs() < 1e-11, "{name} {mode:?} {growth}");
                assert!((mode.angle - angle).abs() < 1e-11, "{name} {mode:?} {angle}");
            }
        }
    }
}

#[test]
fn time_steps_up_to_which_integrators_are_stable_are_those_of_numpy() {
    let mut compared = 0;
    for case in cases() {
        let analysis = run(&open(plant(&case), None));
        for (name, wanted) in case["steps"].as_object().unwrap() {
            let found = step(&analysis, name).largest_stable_dt;
            if name == "exact" {
                assert_eq!(found, None);
                continue;
            }
            if let (Some(wanted), Some(found)) = (wanted["largest_stable_dt"].as_f64(), found) {
                compared += 1;
                // The radius is right to 10⁻¹⁵, and a slow mode of the rate r leaves 1 with a slope of about r per step. In
                // a search a growth of 10⁻¹¹ counts as none, with a slope of about one per ωh.
                let slowest = rows(&case["eigenvalues"]).iter().map(|x| -x[0]).fold(1e9, f64::min);
                let tolerance = 1e-10 + 1e-15 / (slowest * wanted);
                assert!((found / wanted - 1.0).abs() < tolerance, "{name} {found} {wanted}");
            } else {
                assert!(wanted["largest_stable_dt"].is_null() && found.is_none(), "{name}");
            }
        }
    }
    // Two for each plant, and seven and two implicit ones more for each mechanical one; the other implicit ones have no limit.
    assert_eq!(compared, 6 * 2 + 6 * 11);
}

#[test]
fn modes_and_deviations_of_loops_are_those_of_numpy() {
    for case in cases() {
        let plant = plant(&case);
        let wanted = &case["loop"];
        let gain = matrix(&wanted["gain"]);
        let n = plant.states.len();
        let controller = DiscreteController::gain(gain.scaled(-1.0));
        let period = wanted["period"].as_f64().unwrap();
        let cost = Matrix::identity(n + 1);
        let linear = LinearLoop::new(plant, controller, period, cost, vec![0.0; n]).unwrap();
        let late = Latency::of_steps(wanted["latency_periods"].as_f64().unwrap()).unwrap();
        let timing = LoopTiming { input_latency: vec![late], ..linear.ideal() };
        let request = LinearRequest {
            linear: linear.clone(),
            timing: Some(timing.clone()),
            dt: None,
            integrator: None,
            operating_point: None,
            is_linearised: false,
            system: None,
            note: None,
        };
        let analysis = run(&request);
        assert!(analysis.steps.is_empty());
        let found = analysis.closed_loop.unwrap();
        let radius = wanted["spectral_radius"].as_f64().unwrap();
        assert!((found.spectral_radius / radius - 1.0).abs() < 1e-12, "{found:?} {radius}");
        let own = log_spectral_radius(&linear.period_matrix(&timing).unwrap());
        assert!((found.mean_square_growth - 2.0 * own).abs() < 1e-12, "{found:?} {own}");
        for (mode, wanted) in found.modes.iter().zip(rows(&wanted["eigenvalues"])) {
            let [re, im] = mode.eigenvalue;
            let off = (re - wanted[0]).hypot(im - wanted[1]);
            assert!(off < 1e-12, "{mode:?} {wanted:?}");
            // e^{sT} of a damping ratio and a natural frequency.
            let size = mode.natural_frequency * period;
            let growth = (-mode.damping_ratio.unwrap() * size).exp();
            assert!((growth / mode.growth - 1.0).abs() < 1e-13, "{mode:?}");
        }
        assert_eq!(found.deviations.len(), n);
        for (found, wanted) in found.deviations.iter().zip(numbers(&wanted["deviations"])) {
            assert!((found.deviation / wanted - 1.0).abs() < 1e-10, "{found:?} {wanted}");
        }
    }
}

#[test]
fn what_does_not_apply_is_refused_with_what_is_allowed() {
    let a = Matrix::from_rows(&[[-2.0]]).unwrap();
    let one = Matrix::identity(1);
    let lag = LinearPlant::new(a, one.clone(), one, Matrix::zeros(1, 1)).unwrap();
    let error = |request: LinearRequest| analyze(&request, &AtomicBool::new(false)).unwrap_err();
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = error(open(lag.clone(), Some(dt)));
        assert!(matches!(error, LinearAnalysisError::Dt(_)), "{error}");
    }
    let verlet = Stepping::from_name("velocity-verlet");
    let text = error(LinearRequest { integrator: verlet, ..open(lag.clone(), None) }).to_string();
    let allowed = "explicit-euler, rk4, damping-stiffness-implicit, backward-euler, implicit-midpoint, trapezoid, gauss-legendre-4, gauss-legendre-6, exact";
    assert!(text.ends_with(&format!("expected {allowed}")), "{text}");
    let sampled = lag.sampled(0.1).unwrap();
    let text = error(open(sampled.clone(), Some(0.1))).to_string();
    assert!(text.starts_with("--dt is given, but the plant is sampled every 0.1 s"), "{text}");
    assert!(run(&open(sampled, None)).steps.is_empty());
    assert_eq!(
        analyze(&open(lag_plant(), Some(0.1)), &AtomicBool::new(true)).unwrap_err(),
        LinearAnalysisError::Interrupted
    );
}

fn lag_plant() -> LinearPlant {
    let one = Matrix::identity(1);
    LinearPlant::new(one.scaled(-1.0), one.clone(), one, Matrix::zeros(1, 1)).unwrap()
}

#[test]
fn steps_that_overflow_have_no_numbers_and_no_panic() {
    for dt in [1e-300, 1e60, 1e300] {
        let analysis = run(&open(lag_plant(), Some(dt)));
        for step in &analysis.steps {
            let known = step.predicted_spectral_radius.is_none_or(f64::is_finite);
            assert!(known, "{step:?}");
        }
    }
}

/// A plant of one input with this matrix.
fn free(rows: &[Vec<f64>]) -> LinearPlant {
    let n = rows.len();
    let b = Matrix::from_rows(&vec![vec![1.0]; n]).unwrap();
    let c = Matrix::identity(n);
    LinearPlant::new(Matrix::from_rows(rows).unwrap(), b, c, Matrix::zeros(n, 1)).unwrap()
}

/// The companion matrix of `(s + shift)ⁿ`.
fn multiple(n: usize, shift: f64) -> Vec<Vec<f64>> {
    let mut coefficients = vec![1.0];
    for _ in 0..n {
        let shifted = coefficients.iter().map(|x| x * shift).chain([0.0]);
        let raised = [0.0].into_iter().chain(coefficients.iter().copied());
        coefficients = shifted.zip(raised).map(|(x, y)| x + y).collect();
    }
    let row = |i: usize| match i + 1 == n {
        true => coefficients[..n].iter().map(|x| -x).collect(),
        false => (0..n).map(|j| f64::from(j == i + 1)).collect(),
    };
    (0..n).map(row).collect()
}

#[test]
fn a_multiple_pole_is_neutral_only_if_it_is_zero() {
    for n in [2, 5, 8, 10] {
        for (shift, wanted) in
            [(1.0, Outcome::Stable), (-3.0, Outcome::Unstable), (0.0, Outcome::Unknown)]
        {
            let found = run(&open(free(&multiple(n, shift)), Some(10.0)));
            assert_eq!(found.verdicts.plant.outcome, wanted, "{n} {shift} {:?}", found.modes);
            // Explicit Euler multiplies by 1 − 10 for each pole of −1, and that of RK4 is 291 there.
            for name in ["explicit-euler", "rk4"].into_iter().filter(|_| shift == 1.0) {
                let verdict = step(&found, name).verdict.clone().unwrap();
                assert_eq!(verdict.outcome, Outcome::Unstable, "{name} {n}: {verdict}");
            }
        }
    }
}

#[test]
fn a_sampled_mode_of_factor_zero_hides_no_growth() {
    for (factor, wanted) in
        [(2.0, Outcome::Unstable), (1.1, Outcome::Unstable), (0.9, Outcome::Stable)]
    {
        let mut plant = free(&[vec![factor, 0.0], vec![0.0, 0.0]]);
        plant.sampling_period = Some(0.01);
        let found = run(&open(plant, None));
        assert_eq!(found.verdicts.plant.outcome, wanted, "{:?}", found.verdicts.plant);
        let rates = found.modes.iter().map(|mode| mode.growth_rate);
        let largest = rates.fold(f64::NEG_INFINITY, f64::max);
        // To the rounding of a logarithm of a factor near 1.
        assert!((largest - factor.ln() / 0.01).abs() < 1e-10 * largest.abs(), "{largest}");
    }
}
