//! Verdicts on steps on linear plants, and on loops around them.

use libration_report::verdict::{Outcome, Verdict};
use serde::Serialize;

use super::{ClosedLoop, StepAnalysis};
use crate::digits::significant;

/// Growth of second moments per period that is rounding.
const ROUNDING: f64 = 1e-12;

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
            closed_loop: closed_loop.map(verdict_of_loop),
        }
    }

    /// All that there are.
    pub fn all(&self) -> impl Iterator<Item = &Verdict> {
        self.step.iter().chain(&self.closed_loop)
    }
}

fn verdict_of_loop(own: &ClosedLoop) -> Verdict {
    let percent = significant(100.0 * own.mean_square_growth.exp_m1().abs(), 4);
    match own.mean_square_growth {
        growth if growth.abs() <= ROUNDING => {
            Verdict::unknown("at the limit of stability, second moments neither grow nor fall")
        }
        growth if growth < 0.0 => {
            Verdict::new(Outcome::Stable, format!("second moments fall by {percent} % per period"))
        }
        _ => Verdict::new(
            Outcome::Unstable,
            format!("second moments grow by {percent} % per period"),
        ),
    }
}
