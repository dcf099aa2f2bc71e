//! What can be wrong with a state.

use thiserror::Error;

/// Why a state cannot be taken up.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum CheckpointError {
    /// It is that of something else.
    #[error("the state does not match: its {name} is {found}; it must be {wanted}")]
    Other {
        /// What is different.
        name: &'static str,
        /// What it is.
        found: String,
        /// What it must be.
        wanted: String,
    },
    /// It has more or fewer bytes.
    #[error("the state has {found} bytes; it must have {wanted}")]
    Length {
        /// How many there are.
        found: usize,
        /// How many there must be.
        wanted: usize,
    },
    /// It contradicts itself.
    #[error("the state is damaged: {0}")]
    Damaged(String),
}
