//! What can go wrong with an export.

use std::io;

use parquet::errors::ParquetError;
use thiserror::Error;

/// Why a table could not be written.
#[derive(Debug, Error)]
pub enum ExportError {
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
    /// The table does not fit into memory.
    #[error("out of memory for a table of {rows} rows")]
    Memory {
        /// The rows asked for.
        rows: u64,
    },
    /// The Parquet library refused.
    #[error("parquet: {0}")]
    Parquet(ParquetError),
}

impl From<ParquetError> for ExportError {
    /// An error of the file beneath stays what it was, so that a broken pipe can be recognised.
    fn from(error: ParquetError) -> Self {
        match error {
            ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(io) => ExportError::Io(*io),
                Err(other) => ExportError::Parquet(ParquetError::External(other)),
            },
            other => ExportError::Parquet(other),
        }
    }
}
