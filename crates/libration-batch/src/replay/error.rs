//! What can be wrong with a replay buffer.

use libration_core::control::ControlError;
use thiserror::Error;

use crate::ensemble::{EnsembleError, InsufficientMemory};
use crate::rl::EnvironmentError;

/// Why a replay buffer cannot be made, filled or drawn from.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ReplayError {
    /// As for environments and rollouts.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// A capacity of nothing.
    #[error("the capacity is 0 {name}; it must be at least 1")]
    Nothing {
        /// Of what.
        name: &'static str,
    },
    /// More at once than there is room for.
    #[error("{name}: {found} in one insertion; the capacity is {room}")]
    Capacity {
        /// Of what.
        name: &'static str,
        /// How many there are.
        found: usize,
        /// For how many there is room.
        room: usize,
    },
    /// There is nothing to draw.
    #[error("the replay buffer has no {0} to draw from; insert a rollout first")]
    Empty(&'static str),
    /// It was made without priorities.
    #[error("the replay buffer has no priorities; create it with priorities")]
    Priorities,
    /// A transition that was never inserted.
    #[error(
        "the number of a transition {index} is {value}; it must be a number from a batch, below {end}"
    )]
    Index {
        /// Which of those given.
        index: usize,
        /// What it is.
        value: u64,
        /// All are below.
        end: u64,
    },
    /// Memory that holds something else.
    #[error("the replay buffer does not match: {what} is {found}; it must be {wanted}")]
    Other {
        /// What is different.
        what: &'static str,
        /// What was found.
        found: String,
        /// What is needed.
        wanted: String,
    },
    /// Memory that holds a replay buffer that is damaged.
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
    /// Nothing, if there are as many as there must be.
    pub(super) fn shape(name: &'static str, found: usize, wanted: usize) -> Result<(), Self> {
        if found == wanted {
            return Ok(());
        }
        Err(EnvironmentError::Shape { name, found, wanted }.into())
    }
}
