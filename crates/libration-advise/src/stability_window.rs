//! Stability windows beyond the first limit.

use libration::linear::{LatencyWindow, LinearLoopError};
use serde::Serialize;

use super::limit_text::{rounded_down, rounded_up};
use super::request::{Measure, Tolerance};
use super::subject::Subject;
use super::timed_loop::TimedLoop;

/// A stability window beyond the first limit that contains the stated size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StabilityWindow {
    /// The smallest size in the window, in the unit of the budget.
    pub from: f64,
    /// The largest size in the window; none if no end was found.
    pub to: Option<f64>,
}

impl StabilityWindow {
    /// Windows of an imperfection beyond the first, in a sentence without a full stop; none if there are none.
    pub fn sentence(name: &str, windows: &[StabilityWindow], unit: &str) -> Option<String> {
        let windows: Vec<String> = windows.iter().map(StabilityWindow::in_words).collect();
        let sentence = || format!("{name} alone is stable again {} {unit}", windows.join(", "));
        (!windows.is_empty()).then(sentence)
    }

    /// The ends in words, without the unit.
    pub fn in_words(&self) -> String {
        match self.to {
            Some(to) => format!("from {} to {}", rounded_up(self.from), rounded_down(to)),
            None => format!("from {}", rounded_up(self.from)),
        }
    }
}

/// Relative accuracy of the ends of a window, which are printed to six digits.
const SHARP: f64 = 1e-7;

impl TimedLoop {
    /// The window around the size `stated` of `subject`, if the loop is stable there but not at smaller sizes above its
    /// first limit `first`. A tolerance of the cost must be met as well. `latencies` are the windows of a latency, if they are known.
    pub(super) fn stability_window(
        &self,
        subject: Subject,
        [first, stated]: [f64; 2],
        tolerance: Tolerance,
        latencies: Option<&[LatencyWindow]>,
    ) -> Result<Option<StabilityWindow>, LinearLoopError> {
        if stated <= first {
            return Ok(None);
        }
        let cost_limit = match tolerance {
            Tolerance { of: Measure::Cost, most } => Some((1.0 + most) * self.cost(&self.ideal())?),
            _ => None,
        };
        if let (Some(windows), None) = (latencies, cost_limit) {
            let around = |window: &&LatencyWindow| {
                window.from <= stated && window.to.is_none_or(|to| stated <= to)
            };
            let around = windows.iter().filter(|window| window.from > 0.0).find(around);
            return Ok(around.map(|&LatencyWindow { from, to, .. }| StabilityWindow { from, to }));
        }
        let holds = |size: f64| -> Result<bool, LinearLoopError> {
            let with = self.single(subject, size)?;
            match cost_limit {
                Some(most) => Ok(self.cost(&with)? <= most),
                None => self.decays(&with),
            }
        };
        if !holds(stated)? {
            return Ok(None);
        }
        let end = |mut inside: f64, mut outside: f64| -> Result<f64, LinearLoopError> {
            while (inside - outside).abs() > SHARP * inside.abs() {
                let middle = 0.5 * (inside + outside);
                if holds(middle)? { inside = middle } else { outside = middle }
            }
            Ok(inside)
        };
        let sizes = self.tried_sizes(subject, self.largest(subject))?;
        // Where no smaller size on the grid fails, the gap is narrow and lies at the first limit.
        let (mut inside, mut below) = (stated, first * (1.0 + 1e-9));
        for &size in sizes.iter().rev().filter(|&&size| first < size && size < stated) {
            if !holds(size)? {
                below = size;
                break;
            }
            inside = size;
        }
        let from = end(inside, below)?;
        let mut inside = stated;
        for &size in sizes.iter().filter(|&&size| size > stated) {
            if !holds(size)? {
                return Ok(Some(StabilityWindow { from, to: Some(end(inside, size)?) }));
            }
            inside = size;
        }
        Ok(Some(StabilityWindow { from, to: None }))
    }
}
