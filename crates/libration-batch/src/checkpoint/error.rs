//! Errors of a checkpoint.

use thiserror::Error;

/// Error of restoring a state.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum CheckpointError {
    /// The traits differ.
    #[error("the state does not match: its {name} is {found}; it must be {wanted}")]
    Other {
        /// The name of the trait.
        name: &'static str,
        /// The value in the state.
        found: String,
        /// The required value.
        wanted: String,
    },
    /// The length is wrong.
    #[error("the state has {found} bytes; it must have {wanted}")]
    Length {
        /// The number of bytes in the state.
        found: usize,
        /// The required number of bytes.
        wanted: usize,
    },
    /// The state is inconsistent.
    #[error("the state is damaged: {0}")]
    Damaged(String),
}
