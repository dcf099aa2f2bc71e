//! A loop whose command arrives late.

use super::quasi::Quasi;
use super::{Feedback, HeldStep, Plant};
use crate::number::Wide;
use crate::{Scalar, State};

/// A latency of the command: so many whole steps, and a part of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latency {
    steps: u64,
    /// At least 0, below 1.
    part: f64,
}

impl Latency {
    /// The most whole steps of which the spectral radius is found.
    pub const MOST_STEPS: u64 = 4096;

    /// A latency in steps, if it is a number that is at least 0 and not too large.
    pub fn of_steps(steps: f64) -> Option<Self> {
        let fits = (0.0..=Self::MOST_STEPS as f64).contains(&steps);
        fits.then(|| Latency { steps: steps.trunc() as u64, part: steps.fract() })
    }

    /// In steps.
    pub fn steps(self) -> f64 {
        self.steps as f64 + self.part
    }
}

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
    pub(super) fn characteristic(&self, feedback: Feedback, latency: Latency) -> Quasi {
        let Latency { steps, part } = latency;
        if part == 0.0 {
            let HeldStep { phi, gamma } = (self.step)(self.dt);
            return polynomial(feedback, steps, phi, gamma, State::origin());
        }
        let part = self.dt * Wide::from_f64(part);
        let (before, after) = ((self.step)(part), (self.step)(self.dt - part));
        let (phi, old) = (after.phi.after(&before.phi), after.phi.apply(&before.gamma));
        polynomial(feedback, steps + 1, phi, old, after.gamma)
    }
}

/// `λᵐ·det(λ − Φ) + K·adj(λ − Φ)·(Γ_old + λ·Γ_new)` for `y' = Φy + Γ_old·u₋ₘ + Γ_new·u₁₋ₘ`.
fn polynomial(
    feedback: Feedback,
    m: u64,
    phi: crate::analysis::UpdateMatrix<Wide, 1>,
    old: State<Wide, 1>,
    new: State<Wide, 1>,
) -> Quasi {
    let trace = phi.trace();
    // The adjugate of λ − Φ is λ + Φ − trace.
    let through = |gamma: State<Wide, 1>| {
        let moved = phi.apply(&gamma).plus(-trace, gamma);
        [feedback.of(&moved), feedback.of(&gamma)]
    };
    let ([old0, old1], [new0, new1]) = (through(old), through(new));
    Quasi { m, a: [phi.determinant(), -trace], b: [old0, old1 + new0, new1] }
}
