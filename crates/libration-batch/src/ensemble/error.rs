//! Errors of an ensemble.

use libration_core::CatalogError;
use libration_core::control::ControlError;

use super::{InstructionSet, InsufficientMemory};

/// Error of an ensemble.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EnsembleError {
    /// There is not memory enough.
    #[error(transparent)]
    Memory(#[from] InsufficientMemory),
    /// The processor lacks the instruction set.
    #[error("this processor has no {}, only {}", requested.name(), available())]
    Instructions {
        /// The requested instruction set.
        requested: InstructionSet,
    },
    /// The system did not give the threads.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// The requested number (0: one per core).
        threads: usize,
        /// The reason that the system gives.
        reason: String,
    },
    /// There are more or fewer values than trajectories.
    #[error(
        "there are {values} {what} for {len} trajectories; there must be one each, or one for all"
    )]
    Length {
        /// The name of the values.
        what: &'static str,
        /// The number of values.
        values: usize,
        /// The number of trajectories.
        len: usize,
    },
    /// A step must take time.
    #[error(
        "the time step is {dt:?} s; it must be a finite number above 0, in the float type as well"
    )]
    TimeStep {
        /// The time step in seconds.
        dt: f64,
    },
    /// The record is shorter than the run.
    #[error("the record of a clock or a delay has {known} steps; the run requires {requested}")]
    Record {
        /// The steps of the record.
        known: u64,
        /// The steps of the run.
        requested: u64,
    },
    /// The number of substeps is 0.
    #[error("there are 0 substeps; there must be at least 1")]
    Substeps,
    /// A parameter of a clock, a delay or a controller is invalid.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The system does not exist so.
    #[error(transparent)]
    System(CatalogError),
    /// `every` is 0.
    #[error("`every` is 0; it must be at least 1 step")]
    Every,
}

fn available() -> String {
    InstructionSet::available().map(InstructionSet::name).collect::<Vec<_>>().join(", ")
}
