//! Costs of Jitterbug and of JitterTime (Lund University).

use libration_linear::{
    Cascade, DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix, Stationary,
};

fn matrix<const N: usize>(rows: &[[f64; N]]) -> Matrix {
    Matrix::from_rows(rows).unwrap()
}

fn stationary(linear: &LinearLoop, inputs: usize, outputs: usize) -> Stationary {
    linear.stationary(&LoopTiming::ideal(inputs, outputs)).unwrap().unwrap()
}

/// The angle of a beam, `4.4/s`, with white noise of unit intensity at its input, and the position of a ball on it, `−9/s²`.
fn ball_and_beam() -> LinearPlant {
    let a = matrix(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [-9.0, 0.0, 0.0]]);
    let b = matrix(&[[4.4], [0.0], [0.0]]);
    let c = matrix(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    LinearPlant::new(a, b, c, Matrix::zeros(2, 1)).unwrap()
}

/// MATLAB's `c2d(…, h, 'matched')` of `0.2 (1 + 1/(10 s) + s/(1 + s/10))`, from the position to the reference of the angle.
///
/// Poles and zeros `s` become `exp(s h)`. MATLAB's documentation does not say where the gains match, which cannot be at `s = 0` for
/// an integrator. `s = 0.1/h` is a deduction: with it all three costs below agree in all digits, with `s = 1` only two do.
fn outer(h: f64) -> DiscreteController {
    let continuous = |s: f64| 0.2 * (1.0 + 1.0 / (10.0 * s) + s / (1.0 + 0.1 * s));
    // The numerator is 11 s² + 10.1 s + 1, the denominator s (s + 10) up to a factor.
    let root = (10.1_f64.powi(2) - 44.0).sqrt();
    let [zero_1, zero_2] = [-10.1 + root, -10.1 - root].map(|s| (s / 22.0 * h).exp());
    let pole = (-10.0 * h).exp();
    let z = 0.1_f64.exp();
    let gain = continuous(0.1 / h) * (z - 1.0) * (z - pole) / ((z - zero_1) * (z - zero_2));
    // In the form of the observer: `u = b₀y + m₁`, `m₁' = b₁y − a₁u + m₂`, `m₂' = b₂y − a₂u`.
    let numerator = [gain, -gain * (zero_1 + zero_2), gain * zero_1 * zero_2];
    let denominator = [-1.0 - pole, pole];
    let input = [0, 1].map(|i| numerator[i + 1] - denominator[i] * gain);
    DiscreteController {
        a: matrix(&[[-denominator[0], 1.0], [-denominator[1], 0.0]]),
        b: matrix(&[[0.0, input[0]], [0.0, input[1]]]),
        c: matrix(&[[1.0, 0.0]]),
        d: matrix(&[[0.0, gain]]),
    }
}

/// Source: Jitterbug's example `multirate.m` has these costs in its comments, `E(φ² + x²)` (B. Lincoln, A. Cervin, *Jitterbug: a tool for
/// analysis of real-time control performance*, IEEE Conference on Decision and Control 2002).
#[test]
fn cascades_of_one_and_of_two_rates_cost_what_jitterbug_computes() {
    // The inner controller is `u = 4 (r − φ)`. A period is 50 ms.
    let inner = DiscreteController::gain(matrix(&[[-4.0, 0.0, 4.0]]));
    let cost = Matrix::diagonal(&[1.0, 1.0, 0.0, 0.0]);
    for (inner_every, outer_every, published) in
        [(2, 2, "3.3955"), (1, 1, "1.9329"), (1, 2, "1.9910")]
    {
        let outer = outer(0.05 * outer_every as f64);
        let inner = inner.clone();
        let cascade = Cascade { inner, outer, inner_every, outer_every, outer_latency: 0 };
        let schedule = cascade.schedule().unwrap();
        let noise = vec![0.0; 2];
        let linear = LinearLoop::new(ball_and_beam(), schedule, 0.05, cost.clone(), noise).unwrap();
        assert_eq!(format!("{:.4}", stationary(&linear, 1, 2).cost), published);
    }
}

/// Source: `test/test_periodic.jl` of JitterTime.jl (<https://github.com/X-N-C/JitterTime.jl>) has the variance; the cost is that of
/// the minimum-variance controller, `(3 + √3)h/6` (K. J. Åström, B. Bernhardsson, *Comparison of Riemann and Lebesgue sampling for
/// first order stochastic systems*, IEEE Conference on Decision and Control 2002).
#[test]
fn an_integrator_under_minimum_variance_control_has_the_variance_of_jittertime() {
    let one = || matrix(&[[1.0]]);
    let plant = LinearPlant::new(Matrix::zeros(1, 1), one(), one(), Matrix::zeros(1, 1)).unwrap();
    let root = 3.0_f64.sqrt();
    let controller = DiscreteController::gain(matrix(&[[-(3.0 + root) / (2.0 + root)]]));
    let cost = Matrix::diagonal(&[1.0, 0.0]);
    let linear = LinearLoop::new(plant, controller, 1.0, cost, vec![0.0]).unwrap();
    let found = stationary(&linear, 1, 1);
    // The reference has 16 digits; some roundings of 1e-16.
    assert!((found.deviations[0].powi(2) - 1.077_350_269_189_626).abs() < 2e-15);
    assert!((found.cost - (3.0 + root) / 6.0).abs() < 2e-15, "{}", found.cost);
}
