//! Locks of files for one process at a time.

use std::fs::{File, OpenOptions, TryLockError};
use std::ops::Deref;
use std::path::Path;
use std::process;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::DataError;
use crate::regular_file::{ensure_no_link, refuse_links};

/// How long to wait for a lock: a process that was killed holds it until the system has taken it down.
const PATIENCE: Duration = Duration::from_secs(1);

/// A file that is locked until this is dropped, or until its process and all that it forked have ended.
///
/// A process that is being started has a copy of every open file for a moment, and with it the lock: to close the file would
/// not be enough.
#[derive(Debug)]
pub struct LockedFile {
    file: File,
    /// A forked process drops a copy of this, but the lock is not its own.
    owner: u32,
}

impl LockedFile {
    /// Opens a regular file, makes it if there is none, and locks it; waits a moment for a process that holds it.
    ///
    /// # Errors
    /// [`DataError::Locked`] if it is locked, by this process or another; [`DataError::Io`] if the system refuses.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        refuse_links(&mut options);
        let until = Instant::now() + PATIENCE;
        loop {
            ensure_no_link(path).map_err(DataError::io("write", path))?;
            let file = options.open(path).map_err(DataError::io("write", path))?;
            match LockedFile::lock(file, path) {
                Err(DataError::Locked(_)) if Instant::now() < until => {
                    sleep(Duration::from_millis(10));
                }
                ended => return ended,
            }
        }
    }

    /// Locks an open file.
    ///
    /// # Errors
    /// As for [`open`](LockedFile::open).
    pub(crate) fn lock(file: File, path: &Path) -> Result<Self, DataError> {
        LockedFile::try_lock(file).map_err(|error| match error {
            TryLockError::WouldBlock => DataError::Locked(path.to_owned()),
            TryLockError::Error(error) => DataError::io("lock", path)(error),
        })
    }

    /// Locks an open file, of which no path is known yet.
    pub(crate) fn try_lock(file: File) -> Result<Self, TryLockError> {
        file.try_lock()?;
        Ok(LockedFile { file, owner: process::id() })
    }
}

impl Deref for LockedFile {
    type Target = File;

    fn deref(&self) -> &File {
        &self.file
    }
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        if process::id() == self.owner {
            // Closing the file is what remains where this fails.
            let _ = self.file.unlock();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dropped_lock_is_free_although_a_copy_of_the_file_is_open() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("locked");
        let first = LockedFile::open(&path).unwrap();
        // As a process that is being started has one.
        let _copy = first.try_clone().unwrap();
        assert!(matches!(LockedFile::open(&path), Err(DataError::Locked(_))));
        drop(first);
        LockedFile::open(&path).unwrap();
    }

    #[test]
    fn who_follows_another_waits_a_moment_for_its_lock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("locked");
        let first = LockedFile::open(&path).unwrap();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                sleep(Duration::from_millis(100));
                drop(first);
            });
            LockedFile::open(&path).unwrap();
        });
    }
}
