//! The verdict of advice on a simulation, or on a loop around a system of the catalogue.

use libration::linear::{LoopStability, StabilityOutcome};
use libration_analyze::linear_analysis::loop_verdict;
use libration_report::notation::cut_off;
use libration_report::verdict::{Outcome, Verdict};

use super::advice::{Advice, LoopAdvice, ToleranceAnswer};

/// Why a result that was computed does not decide about the loop itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The record has another rate than the loop.
    OtherClock,
    /// The record has too few intervals.
    ShortRecord,
    /// The measured latencies change over time.
    ChangingLatency,
}

impl Doubt {
    /// Makes a verdict unknown, and gives its answer the reason first and what it holds for.
    pub(super) fn apply(self, verdict: &mut Verdict, answer: &mut String) {
        // Few intervals can hide that a loop is bad, not make it so.
        let is_bad = matches!(verdict.outcome, Outcome::Unstable | Outcome::Exceeds);
        if matches!(self, Doubt::ShortRecord) && is_bad {
            return;
        }
        let [reason, premise] = match self {
            Doubt::OtherClock => [
                "the record is not the clock of this loop",
                "For a loop that has the clock of the record",
            ],
            Doubt::ShortRecord => [
                "the record has too few intervals to show how the clock jitters",
                "For a clock that repeats the record",
            ],
            Doubt::ChangingLatency => {
                ["the latencies change over time", "For a constant latency of this size"]
            }
        };
        let not_examined = core::mem::take(&mut verdict.not_examined);
        *verdict = Verdict { not_examined, ..Verdict::unknown(reason) };
        *answer = format!("Whether the loop is stable is unknown: {reason}. {premise}: {answer}");
    }
}

impl Advice {
    /// Makes the verdict on the loop unknown. A loop that is unstable without imperfections stays so: no clock or latency decides that.
    pub fn doubt(&mut self, doubt: Doubt) {
        let is_unstable_alone = self.verdict.outcome == Outcome::Unstable
            && self.looped.as_ref().is_some_and(|looped| looped.budgets.is_empty());
        if !is_unstable_alone {
            doubt.apply(&mut self.verdict, &mut self.answer);
        }
    }

    /// Whether an integrator meets the tolerance, with what was not tried.
    pub(super) fn judge_integrators(&self) -> Verdict {
        let most = self.tolerance.most;
        let verdict = match (self.chosen(), self.tried_down_to) {
            (Some((choice, dt)), _) => Verdict::new(
                Outcome::Within,
                format!(
                    "{} in steps of {:.4e} s: an error of {:.3e} of at most {most:e}",
                    choice.integrator,
                    cut_off(dt, 5),
                    choice.lost
                ),
            ),
            (None, Some(shortest)) => Verdict::unknown(format!(
                "no tried step keeps {most:e}, and steps shorter than {shortest:.4e} s were not tried"
            )),
            (None, None) => {
                let least =
                    self.integrators.iter().map(|choice| choice.lost).fold(f64::INFINITY, f64::min);
                let evidence = match least.is_finite() {
                    true => {
                        format!("the least error of a tried step is {least:.3e}, above {most:e}")
                    }
                    false => format!("no tried step follows the motion, tolerance {most:e}"),
                };
                Verdict::new(Outcome::Exceeds, evidence)
            }
        };
        let not_tried = self.search.iter().flat_map(|search| &search.not_tried);
        not_tried.fold(verdict, Verdict::without)
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
            hidden_by: None,
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
