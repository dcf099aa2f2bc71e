//! Modes of a loop.

use crate::plant_modes::largest;
use crate::{LinearLoop, LinearLoopError, LoopTiming, eigenvalues, eigenvector};

/// A mode of a loop, from period to period.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopMode {
    /// The factor by which it grows in a period.
    pub radius: f64,
    /// The angle by which it turns in a period, from 0 to π rad: 0 without oscillation, and π where it changes its sign with every
    /// period.
    pub angle: f64,
    /// The states of the plant that move most, with their sizes relative to the largest: at least a tenth of it, at most four.
    pub states: Vec<(String, f64)>,
}

impl LinearLoop {
    /// The modes of the loop without jitter and losses, the one that grows fastest first; of a pair one, and at most `count`.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub fn modes(
        &self,
        timing: &LoopTiming,
        count: usize,
    ) -> Result<Vec<LoopMode>, LinearLoopError> {
        let matrix = self.period_matrix(timing)?;
        let mut values = eigenvalues(&matrix).unwrap_or_default();
        values.retain(|value| value.im >= 0.0);
        values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let states = &self.plant().states;
        let mode = |value| {
            let shape = eigenvector(&matrix, value).unwrap_or_default();
            let shown = &shape[..states.len().min(shape.len())];
            LoopMode { radius: value.norm(), angle: value.arg(), states: largest(states, shown) }
        };
        Ok(values.into_iter().take(count).map(mode).collect())
    }
}
