//! Many trajectories at once, from starts around the one that is asked for.

use libration::ensemble::{Execution, InstructionSet};

use super::TrajectoryError;

/// How many trajectories, how far apart they start, and where they run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Copies {
    /// Number of trajectories.
    pub count: usize,
    /// Trajectory `n` of `N` starts from `1 + spread·(2n/(N − 1) − 1)` times the start that is asked
    /// for: the first from `1 − spread`, the last from `1 + spread` times as far out.
    pub spread: f64,
    /// Threads; 0 for as many as there are cores.
    pub threads: usize,
    /// The instruction set; the widest of this processor where none is named.
    pub instructions: Option<InstructionSet>,
}

impl Copies {
    /// By what the start of trajectory `n` is multiplied.
    pub fn scale(&self, n: usize) -> f64 {
        if self.count < 2 {
            return 1.0;
        }
        1.0 + self.spread * (2.0 * n as f64 / (self.count - 1) as f64 - 1.0)
    }

    /// The instruction set, if this processor has it.
    pub(super) fn instruction_set(&self) -> Result<InstructionSet, TrajectoryError> {
        let set = self.instructions.unwrap_or_else(InstructionSet::widest);
        set.is_available().then_some(set).ok_or_else(|| TrajectoryError::Value {
            name: "simd",
            value: set.name().to_owned(),
            allowed: format!("one that this processor has: {}", available()),
        })
    }

    /// Where they run.
    pub(super) fn execution(&self) -> Result<Execution, TrajectoryError> {
        let execution = Execution::serial().instructions(self.instruction_set()?)?;
        Ok(execution.threads(self.threads)?)
    }
}

fn available() -> String {
    InstructionSet::available().map(InstructionSet::name).collect::<Vec<_>>().join(", ")
}
