//! Loops with latency.

use libration_core::control::{Feedback, Latency};
use libration_core::number::Wide;
use libration_core::{Scalar, State};

use super::delay_polynomial::DelayPolynomial;
use super::plant::{fed_back, repeated};
use super::{Plant, ZohStep};
use crate::UpdateMatrix;

impl Plant<'_> {
    /// The spectral radius of the loop that `feedback` closes with `latency`.
    ///
    /// Where the latency has a part of a step, the step splits where the command arrives, into two steps of the
    /// integrator with a command each.
    pub fn spectral_radius(&self, feedback: Feedback, latency: Latency) -> Wide {
        self.characteristic(feedback, latency).radius()
    }

    /// The characteristic polynomial of the loop; its roots are the eigenvalues of the matrix that takes state
    /// and waiting commands to the next step.
    pub(super) fn characteristic(&self, feedback: Feedback, latency: Latency) -> DelayPolynomial {
        let SplitStep { phi, old, new } = self.split(latency.part(), self.dt);
        match latency.part() == 0.0 {
            true => polynomial(feedback, latency.whole(), phi, new, State::origin()),
            false => polynomial(feedback, latency.whole() + 1, phi, old, new),
        }
    }

    /// What comes before a part of a step of `dt` seconds. Of steps on a grid only the one splits in which the part ends.
    pub(super) fn before(&self, part: f64, dt: Wide) -> ZohStep {
        let Some((count, fine)) = &self.grid else { return (self.step)(dt * Wide::from_f64(part)) };
        let places = part * *count as f64;
        let (whole, rest) = (places.trunc(), places.fract());
        let h = dt / Wide::from_f64(*count as f64);
        let first = repeated(&fine(h), whole as u64);
        match rest == 0.0 {
            true => first,
            false => first.then(&fine(h * Wide::from_f64(rest))),
        }
    }

    /// What comes after it.
    pub(super) fn after(&self, part: f64, dt: Wide) -> ZohStep {
        let Some((count, fine)) = &self.grid else {
            return (self.step)(dt - dt * Wide::from_f64(part));
        };
        let places = part * *count as f64;
        let (whole, rest) = (places.trunc(), places.fract());
        let h = dt / Wide::from_f64(*count as f64);
        let left = count - whole as u64;
        match rest == 0.0 {
            true => repeated(&fine(h), left),
            false => fine(h - h * Wide::from_f64(rest)).then(&repeated(&fine(h), left - 1)),
        }
    }

    /// A step of `dt` seconds that splits after a part of it.
    pub(super) fn split(&self, part: f64, dt: Wide) -> SplitStep {
        if part == 0.0 {
            let ZohStep { phi, gamma } = (self.step)(dt);
            return SplitStep { phi, old: State::origin(), new: gamma };
        }
        let [before, after] = [self.before(part, dt), self.after(part, dt)];
        SplitStep {
            phi: after.phi.after(&before.phi),
            old: after.phi.apply(&before.gamma),
            new: after.gamma,
        }
    }
}

/// `y' = Φy + Γ_old·u_old + Γ_new·u_new`: a step within which a command takes over from another.
pub(super) struct SplitStep {
    pub(super) phi: UpdateMatrix<Wide>,
    pub(super) old: State<Wide, 1>,
    pub(super) new: State<Wide, 1>,
}

/// `λᵐ·det(λ − Φ) + K·adj(λ − Φ)·(Γ_old + λ·Γ_new)` for `y' = Φy + Γ_old·u₋ₘ + Γ_new·u₁₋ₘ`.
fn polynomial(
    feedback: Feedback,
    m: u64,
    phi: UpdateMatrix<Wide>,
    old: State<Wide, 1>,
    new: State<Wide, 1>,
) -> DelayPolynomial {
    let trace = phi.trace();
    // The adjugate of λ − Φ is λ + Φ − trace.
    let through = |gamma: State<Wide, 1>| {
        let moved = phi.apply(&gamma).plus(-trace, gamma);
        [fed_back(feedback, &moved), fed_back(feedback, &gamma)]
    };
    let ([old0, old1], [new0, new1]) = (through(old), through(new));
    DelayPolynomial { m, a: [phi.determinant(), -trace], b: [old0, old1 + new0, new1] }
}
