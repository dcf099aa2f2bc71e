//! Errors of data files.

use std::io;
use std::path::{Path, PathBuf};

use libration::checkpoint::CheckpointError;
use libration::replay::ReplayError;
use parquet::errors::ParquetError;
use thiserror::Error;

/// Error of a data file or folder.
#[derive(Debug, Error)]
pub enum DataError {
    /// An I/O error.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// The action.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// Another process holds the lock.
    #[error("another process is using {}; wait for it, or choose another place", .0.display())]
    Locked(PathBuf),
    /// The folder holds a data set, and `resume` is not set.
    #[error("{} holds a data set; use --resume to resume it", .0.display())]
    Exists(PathBuf),
    /// The folder holds other files.
    #[error("{} holds {found}, which is not part of a data set; choose an empty folder", folder.display())]
    ForeignFile {
        /// The folder.
        folder: PathBuf,
        /// The name of a file in it.
        found: String,
    },
    /// The folder holds no data set.
    #[error("{} holds no data set: it has no manifest.jsonl", .0.display())]
    Missing(PathBuf),
    /// The data set has other settings.
    #[error("{} holds a data set with other settings: its {name} is {found}; it must be {wanted}", folder.display())]
    Other {
        /// The folder.
        folder: PathBuf,
        /// The name of the setting.
        name: String,
        /// Its value in the data set.
        found: String,
        /// The required value.
        wanted: String,
    },
    /// The manifest is invalid.
    #[error("line {line} of {} {what}", path.display())]
    Manifest {
        /// The manifest.
        path: PathBuf,
        /// The number of the line, from 1.
        line: usize,
        /// The problem.
        what: String,
    },
    /// A file is damaged.
    #[error("{}: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The problem.
        what: String,
    },
    /// A file of a replay buffer is invalid or damaged.
    #[error("{}: {source}", path.display())]
    Replay {
        /// The file.
        path: PathBuf,
        /// The error of the replay buffer.
        source: ReplayError,
    },
    /// A state does not match.
    #[error("{}: {source}", path.display())]
    State {
        /// The file.
        path: PathBuf,
        /// The error of the state.
        source: CheckpointError,
    },
}

impl DataError {
    /// Converts an I/O error of an action.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> DataError {
        let path = path.to_owned();
        move |source| DataError::Io { action, path, source }
    }
}

/// Error of writing a table.
#[derive(Debug, Error)]
pub enum TableError {
    /// An I/O error.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Two columns of one table differ in length.
    #[error("column `{column}` has {found} values where the first column has {expected}")]
    Ragged {
        /// The column that differs from the first.
        column: String,
        /// The length of the first column.
        expected: usize,
        /// Its own length.
        found: usize,
    },
    /// An error of the Parquet library.
    #[error("parquet: {0}")]
    Parquet(ParquetError),
}

impl From<ParquetError> for TableError {
    /// An error of the file beneath stays what it was, so that a broken pipe can be recognised.
    fn from(error: ParquetError) -> Self {
        match error {
            ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(io) => TableError::Io(*io),
                Err(other) => TableError::Parquet(ParquetError::External(other)),
            },
            other => TableError::Parquet(other),
        }
    }
}
