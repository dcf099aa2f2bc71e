//! What can go wrong with an export.

use std::io;

use libration_data::TableError;
use thiserror::Error;

/// Why a table could not be written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The file or pipe refused.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The table is none, or the format refuses it.
    #[error(transparent)]
    Table(TableError),
}

impl From<TableError> for ExportError {
    /// An error of the file beneath stays what it was, so that a broken pipe can be recognised.
    fn from(error: TableError) -> Self {
        match error {
            TableError::Io(error) => ExportError::Io(error),
            other => ExportError::Table(other),
        }
    }
}
