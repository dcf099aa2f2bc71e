//! Loops around linear plants against `tools/linear_loop_reference.py`, which was written from their definition alone.

use libration::control::{Jitter, Latency};
use libration::linear::{
    ControllerSchedule, DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix,
    log_spectral_radius,
};
use serde_json::Value;

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

pub(crate) fn matrix(value: &Value, columns: usize) -> Matrix {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    match rows.is_empty() {
        true => Matrix::zeros(0, columns),
        false => Matrix::from_rows(&rows).unwrap(),
    }
}

/// The loop of a case, without noise and cost.
pub(crate) fn read_loop(case: &Value) -> LinearLoop {
    let of = |name: &str| matrix(&case[name], 0);
    let plant = LinearPlant::new(of("a"), of("b"), of("c"), of("d")).unwrap();
    let (n, m, p) = (plant.states.len(), plant.inputs.len(), plant.outputs.len());
    let (memory, period) = (case["ac"].as_array().unwrap().len(), number(&case["period"]));
    let controller = DiscreteController {
        a: matrix(&case["ac"], 0),
        b: matrix(&case["bc"], p),
        c: matrix(&case["cc"], memory),
        d: matrix(&case["dc"], p),
    };
    LinearLoop::new(plant, controller, period, Matrix::identity(n + m), vec![0.0; p]).unwrap()
}

/// The latencies and the skew of a case.
pub(crate) fn read_timing(case: &Value) -> LoopTiming {
    let late = |name: &str| -> Vec<Latency> {
        numbers(&case[name]).into_iter().map(|steps| Latency::of_steps(steps).unwrap()).collect()
    };
    LoopTiming {
        input_latency: late("input_latency"),
        output_latency: late("output_latency"),
        skew: number(&case["skew"]),
        ..LoopTiming::ideal(0, 0)
    }
}

/// A controller in state space, with so many measurements.
pub(crate) fn controller(own: &Value, measurements: usize) -> DiscreteController {
    let memory = own["a"].as_array().unwrap().len();
    DiscreteController {
        a: matrix(&own["a"], 0),
        b: matrix(&own["b"], measurements),
        c: matrix(&own["c"], memory),
        d: matrix(&own["d"], measurements),
    }
}

/// The plant of a case.
pub(crate) fn plant_of(case: &Value) -> LinearPlant {
    let of = |name: &str| matrix(&case[name], 0);
    let plant = LinearPlant::new(of("a"), of("b"), of("c"), of("d")).unwrap();
    plant.with_noise(of("g")).unwrap()
}

/// The timing of a case with jitter and losses.
pub(crate) fn timing_of(case: &Value) -> LoopTiming {
    let rms = number(&case["jitter"]);
    LoopTiming {
        jitter: match case["law"].as_str().unwrap() {
            "uniform" => Jitter::Uniform(rms),
            _ => Jitter::Gaussian(rms),
        },
        loss: number(&case["loss"]),
        ..read_timing(case)
    }
}

/// The loop of a case with these controllers, and its timing.
pub(crate) fn read(
    case: &Value,
    controllers: impl Into<ControllerSchedule>,
) -> (LinearLoop, LoopTiming) {
    let of = |name: &str| matrix(&case[name], 0);
    let plant = plant_of(case);
    let (n, m) = (plant.states.len(), plant.inputs.len());
    let mut cost = Matrix::zeros(n + m, n + m);
    cost.set_block((0, 0), &of("state_weights"));
    cost.set_block((n, n), &of("input_weights"));
    let period = number(&case["period"]);
    let noise = numbers(&case["output_noise"]);
    let linear = LinearLoop::new(plant, controllers, period, cost, noise).unwrap();
    (linear, timing_of(case))
}

/// Compares radius, growth, cost and deviations of a case.
pub(crate) fn compare(i: usize, case: &Value, linear: &LinearLoop, timing: &LoopTiming) {
    let close = |found: f64, wanted: f64, what: &str| {
        let off = (found - wanted).abs() / wanted.abs().max(1e-3);
        assert!(off < 1e-8, "{i} {what}: {found} {wanted}, {off:e}");
    };
    let radius = log_spectral_radius(&linear.period_matrix(timing).unwrap()).exp();
    close(radius, number(&case["spectral_radius"]), "radius");
    close(linear.growth(timing).unwrap(), number(&case["growth"]), "growth");
    let found = linear.stationary(timing).unwrap();
    assert_eq!(found.is_none(), case["cost"].is_null(), "{i}");
    let Some(found) = found else { return };
    close(found.cost, number(&case["cost"]), "cost");
    for (found, wanted) in found.deviations.into_iter().zip(numbers(&case["deviations"])) {
        close(found, wanted, "deviation");
    }
}

#[test]
fn radius_growth_cost_and_deviations_are_those_of_a_program_from_the_definition() {
    let reference: Value =
        serde_json::from_str(include_str!("../reference/linear_loops.json")).unwrap();
    let cases = reference["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 60);
    for (i, case) in cases.iter().enumerate() {
        let outputs = case["c"].as_array().unwrap().len();
        let (linear, timing) = read(case, controller(&case["controller"], outputs));
        compare(i, case, &linear, &timing);
    }
}
