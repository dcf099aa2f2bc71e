//! Errors of data sets.

use std::path::PathBuf;

use libration::ensemble::{EnsembleError, InsufficientMemory};
use libration::rl::EnvironmentError;
use libration_data::{DataError, TableError};
use thiserror::Error;

/// Error of writing or verifying a data set.
#[derive(Debug, Error)]
pub enum DatasetError {
    /// A file or folder failed.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The settings of the environments are invalid.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// There is not enough memory for the chunks in flight.
    #[error("{shortage} (chunk.steps is {steps}, chunk.num_envs {environments})")]
    OutOfMemory {
        /// The needed and the available memory.
        shortage: InsufficientMemory,
        /// Steps of a chunk.
        steps: usize,
        /// Environments of a chunk.
        environments: usize,
    },
    /// A table cannot be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The shard does not exist, or there are more shards than groups of environments.
    #[error(
        "shard {index} of {of}: expected a shard from 1 to {of}, and at most as many shards as groups of \
         `chunk.num_envs` environments ({groups})"
    )]
    Shard {
        /// Which one.
        index: usize,
        /// The number of shards.
        of: usize,
        /// The number of groups.
        groups: usize,
    },
    /// The manifest would be too long.
    #[error(
        "{chunks} chunks, of which a manifest may have {most}: `chunk.steps` or `chunk.num_envs` must be larger, or there must be \
         more shards"
    )]
    Chunks {
        /// The number of chunks.
        chunks: u64,
        /// The largest number.
        most: u64,
    },
    /// Minari numbers episodes over the whole data set.
    #[error(
        "{of} shards: Minari numbers the episodes of the whole data set and requires a single shard"
    )]
    Whole {
        /// The number of shards.
        of: usize,
    },
    /// The folders are not all shards of one data set, each of them once.
    #[error("the folders are no data set together: {what}")]
    Parts {
        /// The shard that is missing or there twice.
        what: String,
    },
    /// A shard cannot be joined.
    #[error("{}: {what}", folder.display())]
    Part {
        /// The folder of the shard.
        folder: PathBuf,
        /// The reason and a suggestion.
        what: String,
    },
    /// The settings in the manifest cannot be read.
    #[error("the settings in the manifest of {} cannot be read: {what}", folder.display())]
    Settings {
        /// The folder.
        folder: PathBuf,
        /// The reason.
        what: String,
    },
    /// The chunks of the manifest are not the first ones in order.
    #[error("the manifest of {} cannot be continued: {what}", folder.display())]
    Order {
        /// The folder.
        folder: PathBuf,
        /// The wrong chunk, its place and a suggestion.
        what: String,
    },
    /// Another version wrote the data set and may compute other numbers.
    #[error("{} was written by version {found}; this is {}, which may compute other numbers", folder.display(), env!("CARGO_PKG_VERSION"))]
    Version {
        /// The folder.
        folder: PathBuf,
        /// The version that wrote it.
        found: String,
    },
    /// A broken file that cannot be recomputed.
    #[error("{} {what}", path.display())]
    Unrepairable {
        /// The file.
        path: PathBuf,
        /// Its error.
        what: String,
    },
    /// The user stopped the work.
    #[error("interrupted")]
    Interrupted,
}

impl From<EnsembleError> for DatasetError {
    fn from(error: EnsembleError) -> Self {
        DatasetError::Environment(error.into())
    }
}

impl DatasetError {
    /// The missing memory, if that is the error.
    pub fn missing_memory(&self) -> Option<&InsufficientMemory> {
        match self {
            DatasetError::OutOfMemory { shortage, .. } => Some(shortage),
            DatasetError::Environment(error) => error.insufficient_memory(),
            _ => None,
        }
    }

    /// The error of settings that cannot be read.
    pub(super) fn settings(folder: &std::path::Path) -> impl Fn(&dyn ToString) -> Self {
        let folder = folder.to_owned();
        move |what| DatasetError::Settings { folder: folder.clone(), what: what.to_string() }
    }
}
