//! Verdicts on steps on linear plants, and on loops around them.

use libration_report::verdict::Verdict;
use serde::Serialize;

use super::{ClosedLoop, StepAnalysis};

/// The verdicts of an analysis of a linear plant. The plant itself has none: that it is unstable is no fault.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LinearVerdicts {
    /// Whether the step lets deviations grow more than exact steps do; none without one integrator and a time step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<Verdict>,
    /// Whether the loop is stable; none without a loop.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<Verdict>,
}

impl LinearVerdicts {
    pub(super) fn new(step: Option<&StepAnalysis>, closed_loop: Option<&ClosedLoop>) -> Self {
        LinearVerdicts {
            step: step.and_then(|step| step.verdict.clone()),
            closed_loop: closed_loop.map(|own| own.verdict.clone()),
        }
    }

    /// All that there are.
    pub fn all(&self) -> impl Iterator<Item = &Verdict> {
        self.step.iter().chain(&self.closed_loop)
    }
}
