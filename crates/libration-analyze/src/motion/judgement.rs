//! The verdict on a motion.

use libration_report::verdict::{Outcome, Verdict};

use super::reference::{End, Reference};
use super::{MotionExamination, SMALL, StateExamination};
use crate::digits::significant;

/// Fewer samples of the exact motion than up to this step decide nothing, unless fewer steps are examined.
const LEAST_STEPS: u64 = 1000;

/// What exceeds the limit first.
pub(super) struct Excess {
    pub(super) step: u64,
    pub(super) state: usize,
    /// Whether the exact motion is known there.
    pub(super) is_known: bool,
}

impl MotionExamination {
    /// Whether states were compared after each examined step.
    fn compares_all(&self) -> bool {
        self.compared_steps as u64 >= self.examined_steps
    }

    /// The verdict on the motion over `steps` steps of `dt` seconds, fewer than those of the request where they take long.
    pub(super) fn judge(
        &self,
        dt: f64,
        excess: Option<Excess>,
        unsure: Option<u64>,
        steps: u64,
        reference: &Reference,
    ) -> Verdict {
        let time = |step: u64| significant(step as f64 * dt, 6);
        if let (Some(step), Some(why)) = (self.diverged_at_step, &self.undefined) {
            return Verdict::unknown(format!("{why} in step {step}, the first that fails"));
        }
        if let Some(step) = self.diverged_at_step {
            return Verdict::new(
                Outcome::NotResolved,
                format!("a state is not finite after step {step}"),
            );
        }
        if let Some(Excess { step, state, is_known: true }) = excess {
            let StateExamination { name, .. } = &self.states[state];
            let worst = 100.0 * self.states[state].relative_error();
            let least = if self.compares_all() { "" } else { "at least " };
            return Verdict::new(
                Outcome::NotResolved,
                format!(
                    "the error of {name} is above {} % of its motion from step {step} on ({} s), and reaches {least}{} %",
                    100.0 * SMALL,
                    time(step),
                    significant(worst, 3)
                ),
            );
        }
        if let Some(step) = unsure.or(excess.map(|first| first.step)) {
            return Verdict::unknown(format!(
                "the motion amplifies small differences, and the exact one is not known beyond {} s",
                time(step)
            ));
        }
        if let Some(at) = reference.unseen() {
            return Verdict::unknown(format!(
                "the forces have no bound near {} s, or may change the motion between their evaluations there",
                significant(at, 6)
            ));
        }
        if let Some(End::Motion(at)) = reference.end() {
            return Verdict::unknown(format!(
                "the exact motion cannot be followed beyond {} s: it ends there, or its forces jump",
                significant(at, 6)
            ));
        }
        if self.examined_steps < LEAST_STEPS.min(steps) {
            return Verdict::unknown(format!(
                "the reference takes too many steps beyond {} s of {} s, as of a stiff motion",
                time(self.examined_steps),
                time(self.requested_steps)
            ));
        }
        if self.is_at_rest() {
            return Verdict::unknown("the system rests at its start, so that no error shows");
        }
        let worst =
            self.states.iter().max_by(|a, b| a.relative_error().total_cmp(&b.relative_error()));
        let moved = worst.filter(|worst| worst.largest_error > 0.0);
        let evidence = moved.map_or_else(
            || "it has no error".to_owned(),
            |worst| {
                let percent = significant(100.0 * worst.relative_error(), 2);
                let after = match self.compares_all() {
                    true => String::new(),
                    false => format!(" after {} of them", self.compared_steps),
                };
                format!("the largest error{after} is {percent} % of the motion of {}", worst.name)
            },
        );
        let (examined, requested) = (self.examined_steps, self.requested_steps);
        if examined < requested {
            return Verdict::unknown(format!(
                "only the first {examined} of {requested} steps ({} s) were compared with the exact motion, and in these {evidence}; \
                 `--steps {examined}` asks for no more than these",
                time(examined)
            ))
            .without(format!("steps {} to {requested}", examined + 1));
        }
        Verdict::new(Outcome::Resolved, evidence)
    }
}
