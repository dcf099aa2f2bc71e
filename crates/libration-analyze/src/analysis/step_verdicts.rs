//! Verdicts on a step, a motion and a loop.

use libration_report::verdict::{Outcome, Verdict};
use serde::Serialize;

/// The verdicts on a step and a motion. Of a loop there is that of the loop alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StepVerdicts {
    /// Whether the loop is stable; none without a loop.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<Verdict>,
    /// Whether the step lets deviations from the equilibrium, or of a linear system from any motion, grow more than exact steps do. None
    /// without an equilibrium near the motion, where rounding hides the growth, and where the step is stable along a motion that stays away
    /// from the equilibrium.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<Verdict>,
    /// Whether the steps resolve the motion; none of a system that rests at its start, if the step has a verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Verdict>,
}

impl StepVerdicts {
    /// Whether an instability of the step is known.
    pub fn is_unstable(&self) -> bool {
        self.step.as_ref().is_some_and(|verdict| verdict.outcome == Outcome::Unstable)
    }

    /// The verdicts on the loop, the step and the motion, as far as there are any.
    pub fn all(&self) -> impl Iterator<Item = &Verdict> {
        self.closed_loop.iter().chain(&self.step).chain(&self.motion)
    }
}
