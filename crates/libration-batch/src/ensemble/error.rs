//! What can be wrong with an ensemble.

use libration_core::CatalogError;
use libration_core::control::ControlError;

use super::{InstructionSet, InsufficientMemory};

/// Why an ensemble cannot be made or run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EnsembleError {
    /// There is not memory enough.
    #[error(transparent)]
    Memory(#[from] InsufficientMemory),
    /// The processor lacks the instruction set.
    #[error("this processor has no {}, only {}", asked.name(), available())]
    Instructions {
        /// What was asked for.
        asked: InstructionSet,
    },
    /// The system did not give the threads.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many were asked for; 0 for as many as there are cores.
        threads: usize,
        /// What the system says.
        reason: String,
    },
    /// There are more or fewer values than trajectories.
    #[error(
        "there are {values} {what} for {len} trajectories; there must be one each, or one for all"
    )]
    Length {
        /// What the values are.
        what: &'static str,
        /// How many there are.
        values: usize,
        /// How many trajectories there are.
        len: usize,
    },
    /// A step must take time.
    #[error(
        "the time step is {dt:?} s; it must be a finite number above 0, in the float type as well"
    )]
    TimeStep {
        /// What it is, in seconds.
        dt: f64,
    },
    /// What was recorded is not made longer.
    #[error("the record of a clock or a delay has {known} steps; the run requires {asked}")]
    Record {
        /// Steps that there are.
        known: u64,
        /// Steps that are asked for.
        asked: u64,
    },
    /// Nothing would move.
    #[error("there are 0 substeps; there must be at least 1")]
    Substeps,
    /// A clock, a delay or a controller cannot be so.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The system does not exist so.
    #[error(transparent)]
    System(CatalogError),
    /// An observer is to look every 0 steps.
    #[error("`every` is 0; it must be at least 1 step")]
    Every,
}

fn available() -> String {
    InstructionSet::available().map(InstructionSet::name).collect::<Vec<_>>().join(", ")
}
