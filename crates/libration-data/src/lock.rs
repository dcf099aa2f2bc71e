//! Locks of files for one process at a time.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;

use crate::DataError;

/// Opens a file, makes it if there is none, and locks it until it is closed: a process that dies closes it as well.
///
/// # Errors
/// [`DataError::Locked`] if another process has it; [`DataError::Io`] if the system refuses.
pub fn open_locked(path: &Path) -> Result<File, DataError> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    let file = options.open(path).map_err(DataError::io("write", path))?;
    lock(&file, path)?;
    Ok(file)
}

/// Locks an open file.
///
/// # Errors
/// As for [`open_locked`].
pub(crate) fn lock(file: &File, path: &Path) -> Result<(), DataError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(DataError::Locked(path.to_owned())),
        Err(TryLockError::Error(error)) => Err(DataError::io("lock", path)(error)),
    }
}
