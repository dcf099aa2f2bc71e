//! Commands that act a part of a period late, against SciPy (`tools/fractional_hold_reference.py`).

use libration_core::control::Latency;
use libration_linear::{DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix};

const PERIOD: f64 = 0.4;

/// The plants of the script: `A` and `B`.
fn plants() -> [LinearPlant; 2] {
    let plant = |a: [[f64; 3]; 3], b: [[f64; 2]; 3]| {
        let [a, b] = [Matrix::from_rows(&a), Matrix::from_rows(&b)].map(Option::unwrap);
        LinearPlant::new(a, b, Matrix::identity(3), Matrix::zeros(3, 2)).unwrap()
    };
    [
        plant(
            [[0.0, 1.0, 0.0], [-9.0, -0.5, 0.0], [1.0, 0.0, 0.0]],
            [[0.0, 0.0], [2.0, 0.25], [0.0, 1.0]],
        ),
        plant(
            [[1.5, -2.0, 0.5], [0.25, -3.0, 1.0], [0.0, 4.0, 0.75]],
            [[1.0, -1.0], [0.5, 0.0], [0.0, 2.0]],
        ),
    ]
}

/// The matrix of a period under `u = K x` with a latency of `part` periods: its rows of the plant are `[Φ + Γ₀K, Γ₁]`.
fn period(plant: &LinearPlant, gain: Matrix, part: f64) -> Matrix {
    let controller = DiscreteController::gain(gain);
    let cost = Matrix::zeros(5, 5);
    let linear = LinearLoop::new(plant.clone(), controller, PERIOD, cost, vec![0.0; 3]).unwrap();
    let mut timing = LoopTiming::ideal(2, 3);
    timing.input_latency = vec![Latency::of_steps(part).unwrap(); 2];
    linear.period_matrix(&timing).unwrap()
}

#[test]
fn matrices_of_a_late_command_are_those_of_a_plant_that_holds_its_command() {
    let plants = plants();
    let mut largest: f64 = 0.0;
    for line in include_str!("fractional_hold.txt").lines() {
        let numbers: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
        let (plant, part) = (&plants[numbers[0] as usize], numbers[1]);
        let expected = |from: usize, columns: usize| {
            Matrix::from_fn(3, columns, |i, j| numbers[2 + from + columns * i + j])
        };

        let open = period(plant, Matrix::zeros(2, 3), part);
        let phi = open.block((0, 0), (3, 3));
        let gain = Matrix::from_fn(2, 3, |i, j| f64::from(u8::from(i == j)));
        let closed = period(plant, gain, part);
        // The gain sends the first two states to the two inputs.
        let early = closed.block((0, 0), (3, 3)).plus(&phi.scaled(-1.0)).block((0, 0), (3, 2));
        let late = closed.block((0, 3), (3, 2));
        for (found, expected) in
            [(&phi, expected(0, 3)), (&early, expected(9, 2)), (&late, expected(15, 2))]
        {
            for i in 0..3 {
                for j in 0..expected.columns() {
                    largest = largest.max((found[(i, j)] - expected[(i, j)]).abs());
                }
            }
        }
    }
    // Entries are below 4; exponentials and the difference of two of them round in the last digits.
    assert!(largest < 1e-14, "{largest:e}");
}
