//! Errors of a replay buffer.

use libration_core::control::ControlError;
use thiserror::Error;

use libration_batch::ensemble::{EnsembleError, InsufficientMemory};
use libration_batch::rl::EnvironmentError;

/// Error of a replay buffer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ReplayError {
    /// An error of environments or rollouts.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// A capacity is 0.
    #[error("the capacity is 0 {name}; it must be at least 1")]
    Nothing {
        /// The name of the capacity.
        name: &'static str,
    },
    /// An insertion exceeds the capacity.
    #[error("{name}: {found} in one insertion; the capacity is {capacity}")]
    Capacity {
        /// The name of the capacity.
        name: &'static str,
        /// The number in the insertion.
        found: usize,
        /// The capacity.
        capacity: usize,
    },
    /// The buffer has no transitions.
    #[error("the replay buffer has no {0} to draw from; insert a rollout first")]
    Empty(&'static str),
    /// The buffer has no priorities.
    #[error("the replay buffer has no priorities; create it with priorities")]
    Priorities,
    /// A transition that was never inserted.
    #[error(
        "the number of a transition {index} is {value}; it must be a number from a batch, below {end}"
    )]
    Index {
        /// The index in the given numbers.
        index: usize,
        /// The number.
        value: u64,
        /// The upper bound of all numbers.
        end: u64,
    },
    /// The memory does not hold a matching replay buffer.
    #[error("the replay buffer does not match: {what} is {found}; it must be {wanted}")]
    Other {
        /// The property that differs.
        what: &'static str,
        /// The value in the memory.
        found: String,
        /// The required value.
        wanted: String,
    },
    /// The memory holds a damaged replay buffer.
    #[error("the replay buffer is damaged: {0}")]
    Damaged(String),
}

impl From<InsufficientMemory> for ReplayError {
    fn from(error: InsufficientMemory) -> Self {
        EnvironmentError::from(error).into()
    }
}

impl From<EnsembleError> for ReplayError {
    fn from(error: EnsembleError) -> Self {
        EnvironmentError::from(error).into()
    }
}

impl From<ControlError> for ReplayError {
    fn from(error: ControlError) -> Self {
        EnvironmentError::from(error).into()
    }
}

impl ReplayError {
    /// Returns an error if `found` is not `wanted`.
    pub(super) fn shape(name: &'static str, found: usize, wanted: usize) -> Result<(), Self> {
        if found == wanted {
            return Ok(());
        }
        Err(EnvironmentError::Shape { name, found, wanted }.into())
    }
}
