//! The verdict of advice on a simulation, or on a loop around a system of the catalogue.

use libration::linear::{LoopStability, StabilityOutcome};
use libration_analyze::linear_analysis::loop_verdict;
use libration_report::verdict::{Outcome, Verdict};

use super::advice::{Advice, LoopAdvice, ToleranceAnswer};

impl Advice {
    /// The verdict on a motion without a controller: whether an integrator keeps the tolerance. Of steps that were not tried it is unknown.
    pub(super) fn verdict_of_motion(&self) -> Verdict {
        let ToleranceAnswer { of, most } = self.tolerance;
        match (self.chosen(), self.tried_down_to) {
            (Some((choice, dt)), _) => Verdict::new(
                Outcome::Within,
                format!(
                    "{of} error {:.3e} ≤ {most:e} with {} in steps of {dt:e} s",
                    choice.lost, choice.integrator
                ),
            ),
            (None, Some(shortest)) => Verdict::unknown(format!(
                "no step from {shortest:.4e} s on keeps the {of} error below {most:e}, and shorter ones were not tried"
            )),
            (None, None) => Verdict::new(
                Outcome::Exceeds,
                format!("no tried step keeps the {of} error below {most:e}"),
            ),
        }
    }
}

impl LoopAdvice {
    /// The verdict on a loop; `is_kept` is whether an integrator keeps the tolerance.
    pub(super) fn judged(&self, tolerance: &ToleranceAnswer, is_kept: bool) -> Verdict {
        let combined = &self.combined;
        let of_loop = loop_verdict(&LoopStability {
            // Beside the edge the exact limits decide.
            outcome: match combined.growth {
                growth if growth < 0.0 => StabilityOutcome::Stable,
                growth if growth > 0.0 => StabilityOutcome::Unstable,
                _ => StabilityOutcome::Undecided,
            },
            growth: combined.growth,
        });
        match () {
            () if !of_loop.is_good() => of_loop,
            () if combined.is_contradicted() => {
                Verdict::unknown("the simulation contradicts the theory of the loop")
            }
            () if self.exceeds_tolerated_cost(tolerance) => {
                let rise =
                    combined.cost_increase.map_or("infinite".into(), |rise| format!("{rise:.4e}"));
                Verdict::new(
                    Outcome::Exceeds,
                    format!("rise of the cost {rise}, tolerance {:e}", tolerance.most),
                )
            }
            () if !is_kept => Verdict::new(
                Outcome::Exceeds,
                format!(
                    "no tried step keeps the {} error below {:e}",
                    tolerance.of, tolerance.most
                ),
            ),
            () if combined.simulated.is_none() => of_loop.without("a simulation of the loop"),
            () => of_loop,
        }
    }
}
