//! Whether a data set is what its manifest says.

use std::collections::HashSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use crate::checksum::checksum_of;
use crate::manifest::NAME;
use crate::{DataError, Manifest, Stored};

/// A file that is not what the manifest says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Of which chunk; empty where it is of none.
    pub chunk: String,
    /// Which file, seen from the folder.
    pub path: PathBuf,
    /// What is wrong.
    pub what: String,
    /// Whether the file is missing or has other bytes than the manifest says.
    pub broken: bool,
}

/// Reads all files of a data set and compares their checksums. `go_on` gets the number of bytes in the chunks up to each
/// one that was read, and returns whether to read the next.
pub fn verify(folder: &Path, manifest: &Manifest, mut go_on: impl FnMut(u64) -> bool) -> Vec<Flaw> {
    let (mut flaws, mut bytes) = (Vec::new(), 0);
    for chunk in &manifest.chunks {
        for file in &chunk.files {
            if let Err(what) = sound(folder, file) {
                let (chunk, path) = (chunk.chunk.clone(), file.path.clone());
                flaws.push(Flaw { chunk, path, what, broken: true });
            }
        }
        bytes += chunk.bytes();
        if !go_on(bytes) {
            break;
        }
    }
    flaws
}

/// Files of a folder, seen from there, that its manifest does not name.
///
/// # Errors
/// If a folder cannot be read.
pub fn unlisted(folder: &Path, manifest: &Manifest) -> Result<Vec<PathBuf>, DataError> {
    let files = manifest.chunks.iter().flat_map(|chunk| &chunk.files);
    let mut listed: HashSet<&Path> = files.map(|file| &*file.path).collect();
    listed.insert(Path::new(NAME));
    let (mut found, mut folders) = (Vec::new(), vec![PathBuf::new()]);
    while let Some(inner) = folders.pop() {
        let path = folder.join(&inner);
        for entry in fs::read_dir(&path).map_err(DataError::io("read", &path))? {
            let entry = entry.map_err(DataError::io("read", &path))?;
            let name = inner.join(entry.file_name());
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                folders.push(name);
            } else if !listed.contains(&*name) {
                found.push(name);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn sound(folder: &Path, file: &Stored) -> Result<(), String> {
    let found = File::open(folder.join(&file.path)).and_then(checksum_of);
    let (sum, bytes) = found.map_err(|error| format!("cannot be read: {error}"))?;
    if bytes != file.bytes {
        return Err(format!("has {bytes} bytes; the manifest says {}", file.bytes));
    }
    if sum != file.blake3 {
        return Err(format!("has the checksum {sum}; the manifest says {}", file.blake3));
    }
    Ok(())
}
