//! Redesigned controllers of sampled plants, of one state in closed form.

#![allow(clippy::unwrap_used)]

use libration_core::control::Latency;
use libration_linear::{
    DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix, MissingCommand, RedesignError,
};

/// A sampled plant of one state, `x' = a x + u + w`, that measures it.
fn scalar(a: f64, price: f64) -> LinearLoop {
    let [a, one] = [a, 1.0].map(|x| Matrix::diagonal(&[x]));
    let plant = LinearPlant::new(a, one.clone(), one, Matrix::zeros(1, 1)).unwrap();
    let none = DiscreteController::gain(Matrix::zeros(1, 1));
    let cost = Matrix::diagonal(&[1.0, price]);
    LinearLoop::new(plant.sampled(1.0).unwrap(), none, 1.0, cost, vec![0.0]).unwrap()
}

#[test]
fn with_losses_a_scalar_plant_has_the_gain_of_the_modified_riccati_equation() {
    // S = 1 + a²S − (1 − p)a²S²/(r + S), L. Schenato, B. Sinopoli, M. Franceschetti, K. Poolla, S. Sastry, Foundations of control and
    // estimation over lossy networks, Proceedings of the IEEE 95, 2007: a quadratic equation.
    for (a, price, loss) in
        [(1.2_f64, 0.5, 0.3), (1.5, 0.01, 0.2), (0.8, 2.0, 0.9), (1.1, 1.0, 0.0)]
    {
        let linear = scalar(a, price);
        let missing = MissingCommand::Zero;
        let timing = LoopTiming { loss, missing, ..linear.ideal() };
        let found = linear.redesign(&timing).unwrap();
        let (square, half) = (1.0 - loss * a * a, 0.5 * (price * (1.0 - a * a) - 1.0));
        let wanted = ((half * half + square * price).sqrt() - half) / square;
        // Noise of unit variance costs S in each step.
        assert!((found.cost / wanted - 1.0).abs() < 1e-11, "{a} {} {wanted}", found.cost);
        let gain = a * wanted / (price + wanted);
        assert!((found.controller.d[(0, 0)] + gain).abs() < 1e-11, "{a} {found:?} {gain}");
    }
}

#[test]
fn beyond_a_loss_probability_of_one_over_a_squared_nothing_stabilises() {
    for (a, price) in [(1.1_f64, 0.1), (1.5, 1.0), (3.0, 0.01)] {
        let linear = scalar(a, price);
        let critical = (a * a).recip();
        let redesign = |loss: f64| {
            let timing = LoopTiming { loss, missing: MissingCommand::Zero, ..linear.ideal() };
            linear.redesign(&timing)
        };
        assert!(redesign(0.98 * critical).is_ok(), "{a}");
        let error = redesign(1.01 * critical).unwrap_err();
        assert!(matches!(error, RedesignError::NotStabilised { .. }), "{a} {error}");
    }
}

#[test]
fn a_sampled_plant_costs_what_the_equations_of_filter_and_regulator_predict() {
    let a = Matrix::from_rows(&[[1.0, 0.1], [0.2, 1.1]]).unwrap();
    let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
    let c = Matrix::from_rows(&[[1.0, 0.0]]).unwrap();
    let plant = LinearPlant::new(a, b, c, Matrix::diagonal(&[0.5])).unwrap().sampled(0.1).unwrap();
    let none = DiscreteController::gain(Matrix::zeros(1, 1));
    let cost = Matrix::diagonal(&[1.0, 0.5, 0.2]);
    let linear = LinearLoop::new(plant, none, 0.1, cost, vec![0.3]).unwrap();
    for loss in [0.0, 0.1] {
        let late = |steps: f64| vec![Latency::of_steps(steps).unwrap()];
        let timing = LoopTiming { loss, input_latency: late(2.0), ..linear.ideal() };
        let timing = LoopTiming { output_latency: late(1.0), ..timing };
        let found = linear.redesign(&timing).unwrap();
        let closed = linear.with_controller(found.controller).unwrap();
        let real = closed.stationary(&timing).unwrap().unwrap().cost;
        // As of plants in continuous time.
        assert!((real / found.cost - 1.0).abs() < 1e-8, "{loss} {real} {}", found.cost);
    }
}
