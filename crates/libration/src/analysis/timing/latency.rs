//! A loop whose command arrives late.

use super::plant::repeated;
use super::quasi::Quasi;
use super::{Feedback, HeldStep, Plant};
use crate::analysis::UpdateMatrix;
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

    /// No latency.
    pub const NONE: Latency = Latency { steps: 0, part: 0.0 };

    /// A latency in steps, if it is a number that is at least 0 and not too large.
    pub fn of_steps(steps: f64) -> Option<Self> {
        let fits = (0.0..=Self::MOST_STEPS as f64).contains(&steps);
        fits.then(|| Latency { steps: steps.trunc() as u64, part: steps.fract() })
    }

    /// A latency in seconds, of a loop in steps of `dt` seconds: 0.07 s are seven steps of 0.01 s, though their quotient is not
    /// seven in floats.
    pub fn of_seconds(seconds: f64, dt: f64) -> Option<Self> {
        let quotient = seconds / dt;
        let nearest = quotient.round();
        // Three roundings, of both decimals and of their quotient, are less than 2 ε.
        let whole = (quotient - nearest).abs() <= 4.0 * f64::EPSILON * nearest;
        Self::of_steps(if whole { nearest } else { quotient })
    }

    /// In steps.
    pub fn steps(self) -> f64 {
        self.steps as f64 + self.part
    }

    /// The whole steps.
    pub(crate) fn whole(self) -> u64 {
        self.steps
    }

    /// The part of another step.
    pub(crate) fn part(self) -> f64 {
        self.part
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
        let SplitStep { phi, old, new } = self.split(latency.part, self.dt);
        match latency.part == 0.0 {
            true => polynomial(feedback, latency.steps, phi, new, State::origin()),
            false => polynomial(feedback, latency.steps + 1, phi, old, new),
        }
    }

    /// What comes before a part of a step of `dt` seconds, and what after. Of steps on a grid only the one splits in which that is.
    fn pieces(&self, part: f64, dt: Wide) -> (HeldStep, HeldStep) {
        let Some((count, fine)) = &self.grid else {
            let part = dt * Wide::from_f64(part);
            return ((self.step)(part), (self.step)(dt - part));
        };
        let places = part * *count as f64;
        let (whole, rest) = (places.trunc(), places.fract());
        let h = dt / Wide::from_f64(*count as f64);
        let one = fine(h);
        let first = repeated(&one, whole as u64);
        if rest == 0.0 {
            return (first, repeated(&one, count - whole as u64));
        }
        let cut = h * Wide::from_f64(rest);
        let before = first.then(&fine(cut));
        let after = fine(h - cut).then(&repeated(&one, count - whole as u64 - 1));
        (before, after)
    }

    /// A step of `dt` seconds that splits after a part of it.
    pub(super) fn split(&self, part: f64, dt: Wide) -> SplitStep {
        if part == 0.0 {
            let HeldStep { phi, gamma } = (self.step)(dt);
            return SplitStep { phi, old: State::origin(), new: gamma };
        }
        let (before, after) = self.pieces(part, dt);
        SplitStep {
            phi: after.phi.after(&before.phi),
            old: after.phi.apply(&before.gamma),
            new: after.gamma,
        }
    }
}

/// `y' = Φy + Γ_old·u_old + Γ_new·u_new`: a step within which a command takes over from another.
pub(super) struct SplitStep {
    pub(super) phi: UpdateMatrix<Wide, 1>,
    pub(super) old: State<Wide, 1>,
    pub(super) new: State<Wide, 1>,
}

/// `λᵐ·det(λ − Φ) + K·adj(λ − Φ)·(Γ_old + λ·Γ_new)` for `y' = Φy + Γ_old·u₋ₘ + Γ_new·u₁₋ₘ`.
fn polynomial(
    feedback: Feedback,
    m: u64,
    phi: UpdateMatrix<Wide, 1>,
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
