//! What can go wrong with a data set.

use std::path::PathBuf;

use libration::ensemble::{EnsembleError, InsufficientMemory};
use libration::rl::EnvironmentError;
use libration_data::{DataError, TableError};
use thiserror::Error;

/// Why a data set cannot be written or trusted.
#[derive(Debug, Error)]
pub enum DatasetError {
    /// A file or folder.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The environments cannot be so.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// There is not memory enough for the chunks that are on their way at once.
    #[error("{room} (chunk.steps is {steps}, chunk.environments {environments})")]
    Room {
        /// How much is needed, and there.
        room: InsufficientMemory,
        /// Steps of a chunk.
        steps: usize,
        /// Environments of a chunk.
        environments: usize,
    },
    /// A table cannot be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// More shards than there are groups of environments, or one that is none of them.
    #[error(
        "shard {index} of {of}: shards are numbered from 1, and this data set has {groups} groups of environments \
         to divide (chunk.environments)"
    )]
    Shard {
        /// Which one.
        index: usize,
        /// Of how many.
        of: usize,
        /// Groups there are.
        groups: usize,
    },
    /// Episodes are numbered through all of a data set.
    #[error(
        "{of} shards: Minari numbers the episodes of a data set from first to last, so there can only be one"
    )]
    Whole {
        /// Shards that are asked for.
        of: usize,
    },
    /// The manifest tells no settings that can be read.
    #[error("the settings in the manifest of {} cannot be read: {what}", folder.display())]
    Settings {
        /// Of which folder.
        folder: PathBuf,
        /// Why.
        what: String,
    },
    /// The chunks of the manifest are not the first ones in order.
    #[error("the manifest of {} cannot be continued: {what}", folder.display())]
    Order {
        /// Of which folder.
        folder: PathBuf,
        /// Which chunk is wrong where, and what to do.
        what: String,
    },
    /// It was written by another version, which may compute otherwise.
    #[error("{} was written by version {found}; this is {}, which may compute otherwise", folder.display(), env!("CARGO_PKG_VERSION"))]
    Version {
        /// Which folder.
        folder: PathBuf,
        /// By which version.
        found: String,
    },
    /// A broken file that its settings do not lead to.
    #[error("{} {what}", path.display())]
    Unrepairable {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
}

impl From<EnsembleError> for DatasetError {
    fn from(error: EnsembleError) -> Self {
        DatasetError::Environment(error.into())
    }
}

impl DatasetError {
    /// The memory that is missing, if it is that.
    pub fn room(&self) -> Option<&InsufficientMemory> {
        match self {
            DatasetError::Room { room, .. } => Some(room),
            DatasetError::Environment(error) => error.room(),
            _ => None,
        }
    }

    /// Settings that cannot be read.
    pub(super) fn settings(folder: &std::path::Path) -> impl Fn(&dyn ToString) -> Self {
        let folder = folder.to_owned();
        move |what| DatasetError::Settings { folder: folder.clone(), what: what.to_string() }
    }
}
