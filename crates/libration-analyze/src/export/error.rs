//! Errors of exports.

use std::io;

use libration_data::TableError;
use thiserror::Error;

/// Error of an export.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The file or pipe cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The table is invalid, or the format does not support it.
    #[error(transparent)]
    Table(TableError),
}

impl From<TableError> for ExportError {
    /// Keeps I/O errors, so that callers recognise a broken pipe.
    fn from(error: TableError) -> Self {
        match error {
            TableError::Io(error) => ExportError::Io(error),
            other => ExportError::Table(other),
        }
    }
}
