//! A step under a zero-order hold.

use libration_core::number::{Dual, Wide};
use libration_core::system::CommandedSystem;
use libration_core::{Integrator, Model, Scalar, State};

use crate::UpdateMatrix;
use crate::exponential::exponential;

/// One step of a plant with one degree of freedom, `y' = Φy + Γu`, linearised, in 1024 bits.
#[derive(Clone, Copy, Debug)]
pub struct ZohStep {
    /// The matrix `Φ` on the state.
    pub phi: UpdateMatrix<Wide>,
    /// The effect `Γ` of a unit command.
    pub gamma: State<Wide, 1>,
}

impl ZohStep {
    /// This step and then another, under the same command.
    pub(super) fn then(&self, next: &ZohStep) -> ZohStep {
        ZohStep { phi: next.phi.after(&self.phi), gamma: next.phi.apply(&self.gamma) + next.gamma }
    }

    /// A step of `integrator`, of `dt` seconds, linearised about the state `at` without a command.
    pub fn of(
        integrator: impl Integrator,
        model: impl Model<1>,
        at: &State<f64, 1>,
        dt: Wide,
    ) -> Self {
        let at = at.map(Wide::from_f64);
        let system = model.on::<Dual<Wide>>();
        let step = |state: State<Dual<Wide>, 1>, command| {
            let held = CommandedSystem { system, command: [command] };
            integrator.step(&held, state, Dual::constant(dt)).map(|x| x.du)
        };
        let along = |e: State<Wide, 1>| State {
            q: [Dual { re: at.q[0], du: e.q[0] }],
            v: [Dual { re: at.v[0], du: e.v[0] }],
        };
        let none = Dual::constant(Wide::ZERO);
        ZohStep {
            phi: UpdateMatrix::from_map(|e| step(along(e), none)),
            gamma: step(at.map(Dual::constant), Dual::variable(Wide::ZERO)),
        }
    }

    /// The exact step of `dt` seconds, by the exponential of the generator at `at`.
    ///
    /// The command is a third coordinate that does not change: the exponential of the larger matrix holds both
    /// `Φ` and `Γ` (C. F. Van Loan, *Computing integrals involving the matrix exponential*, IEEE Transactions on
    /// Automatic Control 23, 1978).
    pub fn exact(model: impl Model<1>, at: &State<f64, 1>, dt: Wide) -> Self {
        let generator = UpdateMatrix::of_rates(model, at);
        let mut rows = generator.rows();
        for (row, command) in rows.iter_mut().zip([Wide::ZERO, Wide::one()]) {
            row.push(command);
        }
        rows.push(vec![Wide::ZERO; 3]);
        let all = exponential(&rows, dt);
        let [qq, qv, qu] = [0, 1, 2].map(|j| all[0][j]);
        let [vq, vv, vu] = [0, 1, 2].map(|j| all[1][j]);
        ZohStep {
            phi: UpdateMatrix { dq: State { q: [qq], v: [vq] }, dv: State { q: [qv], v: [vv] } },
            gamma: State { q: [qu], v: [vu] },
        }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::Elementary;
    use libration_core::integrator::{Rk4, SymplecticEuler, VelocityVerlet};
    use libration_core::system::{DampedOscillator, Oscillator};

    use super::*;

    fn close(a: Wide, b: Wide) {
        assert!((a - b).abs().to_f64() < 1e-280, "{} {}", a.to_f64(), b.to_f64());
    }

    #[test]
    fn steps_are_those_of_the_textbooks() {
        let model = Oscillator { omega2: 10.0 };
        let (omega2, h) = (Wide::from_f64(10.0), Wide::from_f64(0.125));
        let z2 = omega2 * h * h;
        let one = Wide::one();
        let at = State { q: [0.0], v: [0.0] };
        let euler = ZohStep::of(SymplecticEuler, model, &at, h);
        close(euler.phi.entry(0, 0), one - z2);
        close(euler.gamma.q[0], h * h);
        close(euler.gamma.v[0], h);
        let verlet = ZohStep::of(VelocityVerlet, model, &at, h);
        close(verlet.gamma.q[0], (h * h).ratio(1, 2));
        close(verlet.gamma.v[0], h * (one - z2.ratio(1, 4)));
        let exact = ZohStep::exact(model, &at, h);
        let (sine, cosine) = (omega2.sqrt() * h).sin_cos();
        close(exact.phi.entry(1, 1), cosine);
        close(exact.gamma.q[0], (one - cosine) / omega2);
        close(exact.gamma.v[0], sine / omega2.sqrt());
    }

    #[test]
    fn an_exact_step_is_the_limit_of_many_of_any_method() {
        let model = DampedOscillator { omega2: 3.0, gamma: 0.7 };
        let at = State { q: [0.0], v: [0.0] };
        let exact = ZohStep::exact(model, &at, Wide::from_f64(0.5));
        let part = ZohStep::of(Rk4, model, &at, Wide::from_f64(0.5 / 1024.0));
        let mut all = part;
        for _ in 0..10 {
            // Φ², and Φ·Γ + Γ.
            let gamma = all.phi.apply(&all.gamma) + all.gamma;
            all = ZohStep { phi: all.phi.after(&all.phi), gamma };
        }
        // RK4's error falls as Δt⁴: 2⁻⁴⁴ of a number below one.
        for (a, b) in exact.phi.rows().concat().into_iter().zip(all.phi.rows().concat()) {
            assert!((a - b).abs().to_f64() < 1e-13);
        }
        assert!((exact.gamma.q[0] - all.gamma.q[0]).abs().to_f64() < 1e-13);
    }
}
