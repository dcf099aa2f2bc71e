//! Integrals over an exact step: process noise and cost.

use crate::Matrix;
use crate::exponential::{halvings, twice};

/// Integrals over an exact step of `ẋ = Ax + Bu` with white noise, under a held command.
#[derive(Clone, Debug)]
pub struct StepIntegrals {
    /// `∫₀ʰ e^{As} V e^{Aᵀs} ds`: the covariance of what noise of intensity `V` adds to the state.
    pub noise: Matrix,
    /// The cost of that noise within the step, independent of the state.
    pub constant: f64,
    /// The integral of the cost over the step as a form of the state and the command at its beginning.
    pub cost: Matrix,
}

impl StepIntegrals {
    /// The integrals over `h` seconds, with noise of intensity `noise` and a cost rate that is the form `cost` of state and command.
    ///
    /// Taylor's series of a short step, doubled until it has the length: `W(2h) = W + ΦWΦᵀ` and so on. Nothing grows that decays,
    /// as it does in the exponential of a block matrix (C. F. Van Loan, *Computing integrals involving the matrix exponential*,
    /// IEEE Transactions on Automatic Control 23, 1978).
    pub fn new(a: &Matrix, b: &Matrix, noise: &Matrix, cost: &Matrix, h: f64) -> Self {
        // A part of norm below ½: the terms of sums from both sides fall by a factorial.
        const TERMS: u32 = 24;
        let (n, m) = (a.rows(), b.columns());
        let mut generator = Matrix::zeros(n + m, n + m);
        generator.set_block((0, 0), a);
        generator.set_block((0, n), b);
        let doublings = halvings(h * generator.row_sum_norm().max(a.transposed().row_sum_norm()));
        let short = h * 2.0_f64.powi(-doublings);
        let back = generator.transposed();
        let of_states = cost.block((0, 0), (n, n));
        // The derivatives of W, of the form, and of the flow, each at zero.
        let (mut w, mut form) = (noise.clone(), cost.clone());
        let mut power = Matrix::identity(n + m);
        let mut all = StepIntegrals {
            noise: Matrix::zeros(n, n),
            constant: 0.0,
            cost: Matrix::zeros(n + m, n + m),
        };
        // What is added to the flow of no time, as in `exponential`.
        let mut grown = Matrix::zeros(n + m, n + m);
        let mut share = 1.0;
        for k in 1..=TERMS {
            share *= short / f64::from(k);
            all.noise.add_scaled(share, &w);
            all.cost.add_scaled(share, &form);
            all.constant += share * short / f64::from(k + 1) * of_states.inner(&w);
            power = &generator * &power;
            grown.add_scaled(share, &power);
            let half = a * &w;
            w = half.plus(&half.transposed());
            let half = &back * &form;
            form = half.plus(&half.transposed());
        }
        for _ in 0..doublings {
            let flow = Matrix::identity(n + m).plus(&grown);
            let phi = flow.block((0, 0), (n, n));
            let first = all.cost.block((0, 0), (n, n));
            all.constant = 2.0 * all.constant + first.inner(&all.noise);
            let later = phi.congruence(&all.noise);
            all.noise.add_scaled(1.0, &later);
            let later = flow.transposed().congruence(&all.cost);
            all.cost.add_scaled(1.0, &later);
            grown = twice(&grown);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Discretisation;

    /// An oscillator with `q̈ = −omega2·q − gamma·q̇ + u`.
    fn oscillator(omega2: f64, gamma: f64) -> (Matrix, Matrix) {
        let a = Matrix::from_rows(&[[0.0, 1.0], [-omega2, -gamma]]).unwrap();
        (a, Matrix::from_rows(&[[0.0], [1.0]]).unwrap())
    }

    #[test]
    fn of_an_oscillator_they_are_integrals_of_sines_and_cosines() {
        let (omega2, h) = (10.0_f64, 0.7);
        let (a, b) = oscillator(omega2, 0.0);
        let noise = Matrix::diagonal(&[0.0, 1.0]);
        // With weights ½(ω², 1) the cost is the energy, which nothing but noise changes: half of it in a second.
        let energy = Matrix::diagonal(&[omega2 / 2.0, 0.5, 0.0]);
        let found = StepIntegrals::new(&a, &b, &noise, &energy, h);
        let omega = omega2.sqrt();
        let (sine, cosine) = (2.0 * omega * h).sin_cos();
        // ∫ sin²/ω², ∫ sin·cos/ω, ∫ cos².
        let wanted = [
            (h / 2.0 - sine / (4.0 * omega)) / omega2,
            (1.0 - cosine) / (4.0 * omega2),
            h / 2.0 + sine / (4.0 * omega),
        ];
        let noise = &found.noise;
        for (found, wanted) in [noise[(0, 0)], noise[(0, 1)], noise[(1, 1)]].into_iter().zip(wanted)
        {
            // Some roundings, of numbers below one.
            assert!((found - wanted).abs() < 2e-15, "{found} {wanted}");
        }
        // Five doublings double what rounding leaves of numbers up to 3.5.
        let off = [
            found.cost[(0, 0)] - h * omega2 / 2.0,
            found.cost[(1, 1)] - h / 2.0,
            found.cost[(0, 1)],
            found.constant - h * h / 4.0,
        ];
        assert!(off.iter().all(|x| x.abs() < 1e-13), "{off:?}");
    }

    #[test]
    fn they_are_the_sums_over_many_short_steps() {
        let h = 0.4;
        let (a, b) = oscillator(-3.0, 0.7);
        let form = Matrix::diagonal(&[5.0, 0.5, 0.2]);
        let found = StepIntegrals::new(&a, &b, &Matrix::diagonal(&[0.0, 1.0]), &form, h);
        // From (q, v) = (1, −2) under u = 3; Simpson's rule on 2¹⁰ intervals, whose error is below 10⁻¹³.
        const PARTS: u32 = 1 << 10;
        let start = [1.0, -2.0, 3.0];
        let (mut cost, mut noise) = (0.0, Matrix::zeros(2, 2));
        for k in 0..=PARTS {
            let weight = match k {
                0 | PARTS => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            } * h
                / (3.0 * f64::from(PARTS));
            let Discretisation { phi, gamma } =
                Discretisation::exact(&a, &b, h * f64::from(k) / f64::from(PARTS));
            let moved = phi.apply(&start[..2]);
            let [q, v] = [0, 1].map(|i| moved[i] + 3.0 * gamma[(i, 0)]);
            cost += weight * (5.0 * q * q + 0.5 * v * v + 0.2 * 9.0);
            let impulse = [phi[(0, 1)], phi[(1, 1)]];
            noise.add_scaled(weight, &Matrix::from_fn(2, 2, |i, j| impulse[i] * impulse[j]));
        }
        let value: f64 = found.cost.apply(&start).iter().zip(start).map(|(x, y)| x * y).sum();
        assert!((value / cost - 1.0).abs() < 1e-12, "{value} {cost}");
        for (found, wanted) in found.noise.entries().iter().zip(noise.entries()) {
            assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
        }
    }
}
