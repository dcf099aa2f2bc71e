//! Redesigned controllers against `tools/redesign_reference.py`, which was written from the definition of the loop alone.

use libration::linear::{LinearLoop, LoopTiming, Matrix, Redesign};
use serde_json::Value;

use crate::linear_reference::{matrix, number, numbers, plant_of, timing_of};

/// The loop of a case without a controller, its timing, and its redesign.
fn redesigned(case: &Value) -> (LinearLoop, LoopTiming, Redesign) {
    let plant = plant_of(case);
    let (n, m, p) = (plant.states.len(), plant.inputs.len(), plant.outputs.len());
    let mut cost = Matrix::zeros(n + m, n + m);
    cost.set_block((0, 0), &matrix(&case["state_weights"], 0));
    cost.set_block((n, n), &matrix(&case["input_weights"], 0));
    let none = libration::linear::DiscreteController::gain(Matrix::zeros(m, p));
    let noise = numbers(&case["output_noise"]);
    let linear = LinearLoop::new(plant, none, number(&case["period"]), cost, noise).unwrap();
    let timing = timing_of(case);
    let redesign = linear.redesign(&timing).unwrap();
    (linear, timing, redesign)
}

fn cost(linear: &LinearLoop, timing: &LoopTiming, redesign: &Redesign) -> f64 {
    let closed = linear.with_controller(redesign.controller.clone()).unwrap();
    closed.stationary(timing).unwrap().unwrap().cost
}

fn reference() -> Value {
    serde_json::from_str(include_str!("../reference/redesigns.json")).unwrap()
}

#[test]
fn cost_and_markov_parameters_of_lqg_are_those_of_scipy() {
    let reference = reference();
    let cases = reference["even"].as_array().unwrap();
    assert_eq!(cases.len(), 12);
    for (k, case) in cases.iter().enumerate() {
        let (linear, timing, redesign) = redesigned(case);
        let (found, wanted) = (cost(&linear, &timing, &redesign), number(&case["cost"]));
        assert!((found / wanted - 1.0).abs() < 1e-7, "{k}: {found} {wanted}");
        // D, CB, CAB, …, of any coordinates of the memory.
        let controller = &redesign.controller;
        let mut power = controller.b.clone();
        let mut parameters = vec![controller.d.clone()];
        let markov = case["markov"].as_array().unwrap();
        for _ in 1..markov.len() {
            parameters.push(&controller.c * &power);
            power = &controller.a * &power;
        }
        let wanted: Vec<Matrix> = markov.iter().map(|rows| matrix(rows, 0)).collect();
        let largest = wanted.iter().map(Matrix::largest).fold(0.0, f64::max);
        for (mut found, wanted) in parameters.into_iter().zip(wanted) {
            found.add_scaled(-1.0, &wanted);
            assert!(found.largest() < 1e-7 * largest, "{k}: {} {largest}", found.largest());
        }
    }
}

#[test]
fn with_jitter_and_losses_the_cost_is_the_least_that_a_minimiser_finds() {
    let reference = reference();
    let cases = reference["drawn"].as_array().unwrap();
    assert_eq!(cases.len(), 3);
    for (k, case) in cases.iter().enumerate() {
        let (linear, timing, redesign) = redesigned(case);
        let (found, least) = (cost(&linear, &timing, &redesign), number(&case["cost"]));
        // The minimiser stops where differences of costs are rounding.
        assert!((found / least - 1.0).abs() < 1e-7, "{k}: {found} {least}");
        let even = LoopTiming { jitter: timing.jitter.with_rms(0.0), loss: 0.0, ..timing.clone() };
        let plain = linear.redesign(&even).unwrap();
        assert!(cost(&linear, &timing, &plain) > found * (1.0 + 1e-6), "{k}");
    }
}
