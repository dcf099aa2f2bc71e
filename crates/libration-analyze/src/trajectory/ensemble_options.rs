//! Options of an ensemble of trajectories.

use libration::catalog::Allowed;
use libration::ensemble::{Execution, InstructionSet, MOST_THREADS};

use super::TrajectoryError;
use super::error::value_error;

/// Number of trajectories, spread of their starts, and execution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnsembleOptions {
    /// Number of trajectories.
    pub count: usize,
    /// Trajectory `n` of `N` starts from `1 + spread·(2n/(N − 1) − 1)` times the start of the request:
    /// from `1 − spread` for the first to `1 + spread` for the last.
    pub spread: f64,
    /// Number of threads (0: one per core).
    pub threads: usize,
    /// The instruction set; none for the widest of this processor.
    pub instructions: Option<InstructionSet>,
}

impl EnsembleOptions {
    /// The factor of the start of trajectory `n`.
    pub fn scale(&self, n: usize) -> f64 {
        if self.count < 2 {
            return 1.0;
        }
        1.0 + self.spread * (2.0 * n as f64 / (self.count - 1) as f64 - 1.0)
    }

    /// Checks every value.
    pub(crate) fn check(&self) -> Result<(), TrajectoryError> {
        if self.count == 0 {
            return Err(value_error("count", 0, "at least 1"));
        }
        if !self.spread.is_finite() {
            return Err(value_error("spread", format!("{:?}", self.spread), Allowed::Finite));
        }
        if self.threads > MOST_THREADS {
            return Err(value_error("threads", self.threads, format!("at most {MOST_THREADS}")));
        }
        self.instruction_set().map(|_| ())
    }

    /// The instruction set; an error if this processor lacks it.
    pub(super) fn instruction_set(&self) -> Result<InstructionSet, TrajectoryError> {
        let set = self.instructions.unwrap_or_else(InstructionSet::widest);
        set.is_available().then_some(set).ok_or_else(|| TrajectoryError::Value {
            name: "simd",
            value: set.name().to_owned(),
            allowed: format!("one that this processor has: {}", available()),
        })
    }

    /// The execution of the ensemble.
    pub(crate) fn execution(&self) -> Result<Execution, TrajectoryError> {
        let execution = Execution::serial().instructions(self.instruction_set()?)?;
        Ok(execution.threads(self.threads)?)
    }
}

/// Number of rows of so many steps if all states stay finite: the start, each `every`-th step and the last, of each trajectory.
pub(crate) fn rows(steps: u64, every: u64, ensemble: Option<&EnsembleOptions>) -> u64 {
    let every = every.max(1);
    let kept = (steps / every).saturating_add(1 + u64::from(!steps.is_multiple_of(every)));
    kept.saturating_mul(ensemble.map_or(1, |ensemble| ensemble.count as u64))
}

fn available() -> String {
    InstructionSet::available().map(InstructionSet::name).collect::<Vec<_>>().join(", ")
}
