//! Durable files: complete or absent after a crash.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;

use crate::{DataError, checksum, direct_write};

/// The suffix of the names of incomplete files.
pub(crate) const PART: &str = ".libration-part";

/// The largest file, in bytes, whose checksum needs no second thread.
const SHORT: u64 = 1 << 18;

/// Makes a file under another name, which it loses when all of it is on the disk; `fill` waits for that.
///
/// # Errors
/// If the system reports an error; the file there before is unchanged.
pub(crate) fn make<R>(
    path: &Path,
    fill: impl FnOnce(&Path) -> io::Result<R>,
) -> Result<R, DataError> {
    let mut part = path.as_os_str().to_owned();
    part.push(PART);
    let part = PathBuf::from(part);
    let made = fill(&part).and_then(|made| fs::rename(&part, path).map(|()| made));
    made.map_err(|error| {
        // There is nobody to tell that rubbish stays.
        let _ = fs::remove_file(&part);
        DataError::io("write", path)(error)
    })
}

/// Writes a file: under another name until all of it is on the disk. Gives the checksum of what was written, and its length.
///
/// # Errors
/// If the system reports an error; the file there before is unchanged.
pub fn write_file(path: &Path, pieces: &[&[u8]]) -> Result<(String, u64), DataError> {
    let bytes = pieces.iter().map(|piece| piece.len() as u64).sum();
    let sum = || checksum(pieces.iter().copied());
    let create = || make(path, |part| direct_write::create(part, pieces));
    if bytes < SHORT {
        create()?;
        return Ok((sum(), bytes));
    }
    // To sum takes about as long as to write.
    thread::scope(|scope| {
        let summing = thread::Builder::new().spawn_scoped(scope, sum);
        create()?;
        // A thread that only sums does not panic; without one it is done now.
        Ok((summing.map_or_else(|_| sum(), |thread| thread.join().unwrap_or_default()), bytes))
    })
}

/// Writes a file past the page cache, if possible, without the checksum and renaming of [`write_file`]. Benchmarks compare both.
///
/// # Errors
/// If the system reports an error.
pub fn write_direct(path: &Path, pieces: &[&[u8]]) -> Result<(), DataError> {
    direct_write::create(path, pieces).map_err(DataError::io("write", path))
}

/// The folder, or the working directory for a bare name.
pub(crate) fn named(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// Waits until the names in a folder are on the disk.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), DataError> {
    // Only Unix opens folders.
    if cfg!(unix) {
        let synced = File::open(folder).and_then(|folder| folder.sync_all());
        synced.map_err(DataError::io("write", folder))?;
    }
    Ok(())
}

/// Removes what was not whole when its process ended, in a folder and those in it.
pub(crate) fn remove_parts(folder: &Path) -> Result<(), DataError> {
    let failed = || DataError::io("read", folder);
    for entry in fs::read_dir(folder).map_err(failed())? {
        let entry = entry.map_err(failed())?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(failed())?);
        if kind.is_dir() {
            remove_parts(&path)?;
        } else if kind.is_file() && path.to_string_lossy().ends_with(PART) {
            fs::remove_file(&path).map_err(DataError::io("remove", &path))?;
        }
    }
    Ok(())
}
