//! Errors of batches of linear loops.

use libration_linear::LinearLoopError;
use thiserror::Error;

use libration_batch::ensemble::InsufficientMemory;

/// Error of a batch of linear loops.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LinearLoopsError {
    /// The loop or its timing is invalid.
    #[error(transparent)]
    Loop(#[from] LinearLoopError),
    /// There is not enough memory.
    #[error(transparent)]
    Memory(#[from] InsufficientMemory),
    /// The plant moves too fast for the lengths of periods.
    #[error(
        "the plant moves too fast for periods from {shortest} s to {longest} s; help: lower the jitter or leave out the fastest states"
    )]
    Lengths {
        /// The shortest period in s.
        shortest: f64,
        /// The longest period in s.
        longest: f64,
    },
    /// The steps in a period are too many.
    #[error(
        "the longest step is {longest} s; expected at least 1e-7 of the longest period, {period} s"
    )]
    Steps {
        /// The longest step in s.
        longest: f64,
        /// The longest period in s.
        period: f64,
    },
    /// The controller changes with each drawn period.
    #[error(
        "the controller measures the length of each period, and periods are uneven; expected the nominal period (`clock = \"nominal\"`), or no jitter"
    )]
    MeasuredClock,
    /// There are no loops.
    #[error("the number of loops is 0; expected at least 1")]
    NoLoops,
    /// A list of numbers has the wrong length.
    #[error("{given} {of}; expected {expected}")]
    Length {
        /// The numbers.
        of: &'static str,
        /// Their count.
        given: usize,
        /// The expected count, with its reason.
        expected: String,
    },
    /// A number is infinite or NaN.
    #[error("{of} has the entry {value}; expected finite numbers")]
    Entry {
        /// The numbers.
        of: &'static str,
        /// The entry.
        value: f64,
    },
}
