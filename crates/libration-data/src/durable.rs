//! Files that are there whole, or not at all, whatever happens.

use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::thread;

use crate::{DataError, checksum, direct};

/// What names end with until a file is whole.
pub(crate) const PART: &str = ".part";

/// Writes a file: under another name until all of it is on the disk. Gives the checksum of what was written, and its length.
///
/// # Errors
/// If the system refuses; what stood there before stands there still.
pub fn write_file(path: &Path, pieces: &[&[u8]]) -> Result<(String, u64), DataError> {
    let mut part = path.as_os_str().to_owned();
    part.push(PART);
    let part = PathBuf::from(part);
    // To sum takes about as long as to write.
    let (sum, written) = thread::scope(|scope| {
        let sum = scope.spawn(|| checksum(pieces.iter().copied()));
        let written = direct::create(&part, pieces).and_then(|()| fs::rename(&part, path));
        // A thread that only sums does not panic.
        (sum.join().unwrap_or_default(), written)
    });
    written.map_err(|error| {
        // There is nobody to tell that rubbish stays.
        let _ = fs::remove_file(&part);
        DataError::io("write", path)(error)
    })?;
    Ok((sum, pieces.iter().map(|piece| piece.len() as u64).sum()))
}

/// The names in a folder are on the disk.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), DataError> {
    // Only Unix opens folders.
    if cfg!(unix) {
        let synced = File::open(folder).and_then(|folder| folder.sync_all());
        synced.map_err(DataError::io("write", folder))?;
    }
    Ok(())
}

/// Removes what was not whole when its process ended.
pub(crate) fn remove_parts(folder: &Path) -> Result<(), DataError> {
    let failed = || DataError::io("read", folder);
    for entry in fs::read_dir(folder).map_err(failed())? {
        let path = entry.map_err(failed())?.path();
        let is_part = path
            .file_name()
            .map(OsString::from)
            .is_some_and(|name| name.to_string_lossy().ends_with(PART));
        if is_part && path.is_file() {
            fs::remove_file(&path).map_err(DataError::io("remove", &path))?;
        }
    }
    Ok(())
}
