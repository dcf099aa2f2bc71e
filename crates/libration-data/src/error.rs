//! What can go wrong with files of numbers.

use std::io;
use std::path::{Path, PathBuf};

use libration::checkpoint::CheckpointError;
use libration::replay::ReplayError;
use parquet::errors::ParquetError;
use thiserror::Error;

/// Why a file or a folder cannot be written, read or trusted.
#[derive(Debug, Error)]
pub enum DataError {
    /// The system refuses.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was to be done.
        action: &'static str,
        /// With which file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Another process writes there.
    #[error("another process is using {}; wait for it, or choose another place", .0.display())]
    Locked(PathBuf),
    /// There is a data set, and nobody asked to go on with it.
    #[error("{} holds a data set; use --resume to resume it", .0.display())]
    Exists(PathBuf),
    /// There is something else.
    #[error("{} holds {found}, which is not part of a data set; choose an empty folder", folder.display())]
    ForeignFile {
        /// Where.
        folder: PathBuf,
        /// What lies there.
        found: String,
    },
    /// There is no data set.
    #[error("{} holds no data set: it has no manifest.jsonl", .0.display())]
    Missing(PathBuf),
    /// The data set is of other settings.
    #[error("{} holds a data set with other settings: its {name} is {found}; it must be {wanted}", folder.display())]
    Other {
        /// Where.
        folder: PathBuf,
        /// Which setting.
        name: String,
        /// What it is.
        found: String,
        /// What is asked for.
        wanted: String,
    },
    /// The manifest is none.
    #[error("line {line} of {} {what}", path.display())]
    Manifest {
        /// The manifest.
        path: PathBuf,
        /// Which line, from 1 on.
        line: usize,
        /// What is wrong with it.
        what: String,
    },
    /// A file contradicts itself.
    #[error("{}: {what}", path.display())]
    Damaged {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// A file of a replay buffer is none, or damaged.
    #[error("{}: {source}", path.display())]
    Replay {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ReplayError,
    },
    /// A state is of something else.
    #[error("{}: {source}", path.display())]
    State {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: CheckpointError,
    },
}

impl DataError {
    /// What the system says of an action.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> DataError {
        let path = path.to_owned();
        move |source| DataError::Io { action, path, source }
    }
}

/// Why a table cannot be written.
#[derive(Debug, Error)]
pub enum TableError {
    /// The file or pipe refused.
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
    /// The Parquet library refused.
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
