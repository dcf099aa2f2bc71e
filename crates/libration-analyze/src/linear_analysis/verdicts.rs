//! Verdicts on steps on linear plants, and on loops around them.

use libration_report::verdict::Verdict;
use serde::Serialize;

use super::{ClosedLoop, StepAnalysis};

/// The verdicts of an analysis of a linear plant.
#[derive(Clone, Debug, Serialize)]
pub struct LinearVerdicts {
    /// Whether the modes of the plant grow; unknown of modes that neither grow nor decay. It has no part in the exit code, since that a plant
    /// is unstable by itself is no fault of a step or a loop.
    pub plant: Verdict,
    /// Whether the step lets deviations grow more than exact steps do; none without one integrator and a time step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<Verdict>,
    /// Whether the loop is stable; none without a loop.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<Verdict>,
}

impl LinearVerdicts {
    pub(super) fn new(
        plant: Verdict,
        step: Option<&StepAnalysis>,
        closed_loop: Option<&ClosedLoop>,
    ) -> Self {
        LinearVerdicts {
            plant,
            step: step.and_then(|step| step.verdict.clone()),
            closed_loop: closed_loop.map(|own| own.verdict.clone()),
        }
    }

    /// Those on the step and the loop, from which the exit code follows.
    pub fn all(&self) -> impl Iterator<Item = &Verdict> {
        self.step.iter().chain(&self.closed_loop)
    }
}
