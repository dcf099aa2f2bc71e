//! Integrals over an exact step: process noise and cost.

use libration_core::control::LqrWeights;

use super::Plant;
use super::dense_matrix::exponential;

/// An exact step of `h` seconds under white noise of unit intensity.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepIntegrals {
    /// `∫₀ʰ e^{As} B Bᵀ e^{Aᵀs} ds`: the covariance of what the noise adds to the state.
    pub(super) noise: [[f64; 2]; 2],
    /// The cost of that noise within the step, independent of the state.
    pub(super) constant: f64,
    /// The integral of the cost over the step as a form in `q`, `v` and the command at its beginning.
    pub(super) cost: [[f64; 3]; 3],
}

impl Plant<'_> {
    /// The integrals of a step of `h` seconds, in `f64`.
    ///
    /// They solve linear differential equations, whose matrix exponential is the answer, as C. F. Van Loan has it for a block
    /// matrix (*Computing integrals involving the matrix exponential*, IEEE Transactions on Automatic Control 23, 1978): here the
    /// unknowns are the entries of what is symmetric, so that nothing grows that decays.
    pub(super) fn step_integrals(&self, weights: LqrWeights, h: f64) -> StepIntegrals {
        let [aq, av] = [0, 1].map(|j| self.generator.entry(1, j).to_f64());
        let LqrWeights { position, velocity, command } = weights;
        // W' = AW + WAᵀ + BBᵀ of W_qq, W_qv, W_vv; then the cost of it; last what is constant.
        let noise = last_column(
            &[
                [0.0, 2.0, 0.0, 0.0, 0.0],
                [aq, av, 1.0, 0.0, 0.0],
                [0.0, 2.0 * aq, 2.0 * av, 0.0, 1.0],
                [position, 0.0, velocity, 0.0, 0.0],
                [0.0; 5],
            ],
            h,
        );
        // G' = FᵀG + GF + Q with F of state and command: G_qq, G_qv, G_vv, G_qu, G_vu, G_uu.
        let cost = last_column(
            &[
                [0.0, 2.0 * aq, 0.0, 0.0, 0.0, 0.0, position],
                [1.0, av, aq, 0.0, 0.0, 0.0, 0.0],
                [0.0, 2.0, 2.0 * av, 0.0, 0.0, 0.0, velocity],
                [0.0, 1.0, 0.0, 0.0, aq, 0.0, 0.0],
                [0.0, 0.0, 1.0, 1.0, av, 0.0, 0.0],
                [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, command],
                [0.0; 7],
            ],
            h,
        );
        let [qq, qv, vv, qu, vu, uu, _] = cost;
        StepIntegrals {
            noise: [[noise[0], noise[1]], [noise[1], noise[2]]],
            constant: noise[3],
            cost: [[qq, qv, qu], [qv, vv, vu], [qu, vu, uu]],
        }
    }

    /// The noise of a step of an integrator, in which a constant acceleration of variance `1/h` adds `gain` for each unit of it.
    pub(super) fn held_noise(gain: [f64; 2], h: f64) -> [[f64; 2]; 2] {
        // A step of length zero moves nothing.
        let share = if h > 0.0 { h.recip() } else { 0.0 };
        gain.map(|a| gain.map(|b| a * b * share))
    }
}

/// The last column of `exp(a·h)`.
fn last_column<const N: usize>(a: &[[f64; N]; N], h: f64) -> [f64; N] {
    let power = exponential(a.iter().map(|row| row.iter().map(|x| x * h).collect()).collect());
    core::array::from_fn(|i| power[i][N - 1])
}

#[cfg(test)]
mod tests {
    use libration_core::Scalar;
    use libration_core::number::Wide;
    use libration_core::system::{DampedOscillator, Oscillator};

    use super::super::sample::ORIGIN;
    use super::*;

    const WEIGHTS: LqrWeights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.2 };

    #[test]
    fn of_an_oscillator_they_are_integrals_of_sines_and_cosines() {
        let (omega2, h) = (10.0_f64, 0.7);
        let plant = Plant::exact(Oscillator { omega2 }, ORIGIN, h);
        let found = plant.step_integrals(WEIGHTS, h);
        let omega = omega2.sqrt();
        let (sine, cosine) = (2.0 * omega * h).sin_cos();
        // ∫ sin²/ω², ∫ sin·cos/ω, ∫ cos².
        let wanted = [
            (h / 2.0 - sine / (4.0 * omega)) / omega2,
            (1.0 - cosine) / (4.0 * omega2),
            h / 2.0 + sine / (4.0 * omega),
        ];
        let [[qq, qv], [_, vv]] = found.noise;
        for (found, wanted) in [qq, qv, vv].into_iter().zip(wanted) {
            // Some roundings, of numbers below one.
            assert!((found - wanted).abs() < 1e-15, "{found} {wanted}");
        }
        // With weights ½(ω², 1) the cost is the energy, which nothing but noise changes: half of it in a second.
        let energy = LqrWeights { position: omega2 / 2.0, velocity: 0.5, command: 0.0 };
        let found = plant.step_integrals(energy, h);
        // Five squarings double what rounding leaves of numbers up to 3.5.
        let off = [
            found.cost[0][0] - h * omega2 / 2.0,
            found.cost[1][1] - h / 2.0,
            found.cost[0][1],
            found.constant - h * h / 4.0,
        ];
        assert!(off.iter().all(|x| x.abs() < 1e-13), "{off:?}");
    }

    #[test]
    fn they_are_the_sums_over_many_short_steps() {
        let h = 0.4;
        let plant = Plant::exact(DampedOscillator { omega2: -3.0, gamma: 0.7 }, ORIGIN, h);
        let found = plant.step_integrals(WEIGHTS, h);
        // From (q, v) = (1, −2) under u = 3; Simpson's rule on 2¹⁰ intervals, whose error is below 10⁻¹³.
        const PARTS: u32 = 1 << 10;
        let start = [1.0, -2.0, 3.0];
        let at = |k: u32| {
            let step = (plant.step)(Wide::from_f64(h * f64::from(k) / f64::from(PARTS)));
            let start = libration_core::State { q: [start[0]], v: [start[1]] }.map(Wide::from_f64);
            let moved = step.phi.apply(&start).plus(Wide::from_f64(3.0), step.gamma);
            let [q, v] = [moved.q[0], moved.v[0]].map(Wide::to_f64);
            let impulse = [step.phi.entry(0, 1), step.phi.entry(1, 1)].map(Wide::to_f64);
            let cost = 5.0 * q * q + 0.5 * v * v + 0.2 * 9.0;
            (cost, impulse)
        };
        let (mut cost, mut noise) = (0.0, [[0.0; 2]; 2]);
        for k in 0..=PARTS {
            let weight = match k {
                0 | PARTS => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            } * h
                / (3.0 * f64::from(PARTS));
            let (now, impulse) = at(k);
            cost += weight * now;
            for i in 0..2 {
                for j in 0..2 {
                    noise[i][j] += weight * impulse[i] * impulse[j];
                }
            }
        }
        let form: f64 = (0..3)
            .flat_map(|i| (0..3).map(move |j| (i, j)))
            .map(|(i, j)| found.cost[i][j] * start[i] * start[j])
            .sum();
        assert!((form / cost - 1.0).abs() < 1e-12, "{form} {cost}");
        for (found, wanted) in found.noise.as_flattened().iter().zip(noise.as_flattened()) {
            assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
        }
    }
}
