//! Verification of a data set against its manifest.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::checksum::checksum_of;
use crate::manifest::NAME;
use crate::regular_file::{linked_folder, open_regular};
use crate::{DataError, Manifest, Stored};

/// A file that differs from the manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// The name of the chunk; empty if the file is of none.
    pub chunk: String,
    /// The path relative to the folder.
    pub path: PathBuf,
    /// The problem.
    pub what: String,
    /// Whether the file is missing or has other bytes than the manifest says, and another one can take its place.
    pub broken: bool,
}

/// What of a file is compared with the manifest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// Whether it is there, and its length; it is not read.
    Length,
    /// Its length and its checksum.
    Checksum,
}

/// Compares all files of a data set with its manifest. `go_on` gets the number of bytes in the chunks up to each
/// one that was compared, and returns whether to go on.
pub fn verify(
    folder: &Path,
    manifest: &Manifest,
    comparison: Comparison,
    mut go_on: impl FnMut(u64) -> bool,
) -> Vec<Flaw> {
    let (mut flaws, mut bytes) = (Vec::new(), 0);
    for chunk in &manifest.chunks {
        for file in &chunk.files {
            if let Err((what, broken)) = sound(folder, file, comparison) {
                let (chunk, path) = (chunk.chunk.clone(), file.path.clone());
                flaws.push(Flaw { chunk, path, what, broken });
            }
        }
        bytes = chunk.bytes().saturating_add(bytes);
        if !go_on(bytes) {
            break;
        }
    }
    flaws
}

/// Returns the files of a folder that its manifest does not list, relative to the folder.
///
/// # Errors
/// If a folder cannot be read.
pub fn find_unlisted(folder: &Path, manifest: &Manifest) -> Result<Vec<PathBuf>, DataError> {
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

/// Compares a file with the manifest.
///
/// # Errors
/// The problem, and whether a new file can replace it: a folder cannot be replaced by renaming.
fn sound(folder: &Path, file: &Stored, comparison: Comparison) -> Result<(), (String, bool)> {
    let path = folder.join(&file.path);
    let parent = file.path.parent().unwrap_or(Path::new(""));
    if let Some(link) = linked_folder(folder, parent) {
        let link = link.display();
        return Err((format!("is in `{link}`, which is a link; expected a folder"), false));
    }
    if fs::symlink_metadata(&path).is_ok_and(|found| found.is_dir()) {
        return Err(("is a folder; expected a file".to_owned(), false));
    }
    same(&path, file, comparison).map_err(|what| (what, true))
}

/// Compares a path that is not a folder.
fn same(path: &Path, file: &Stored, comparison: Comparison) -> Result<(), String> {
    let unreadable = |error| format!("cannot be read: {error}");
    // To open a named pipe waits for its writer, and a device may have no end.
    let found = fs::metadata(path).map_err(unreadable)?;
    if !found.is_file() {
        return Err("is not a regular file".to_owned());
    }
    let length = |bytes| format!("has {bytes} bytes; the manifest says {}", file.bytes);
    if found.len() != file.bytes {
        return Err(length(found.len()));
    }
    if comparison == Comparison::Length {
        return Ok(());
    }
    let limited = |found: File| checksum_of(found.take(file.bytes.saturating_add(1)));
    let (sum, bytes) = open_regular(path).and_then(limited).map_err(unreadable)?;
    if bytes != file.bytes {
        return Err(length(bytes));
    }
    if sum != file.blake3 {
        return Err(format!("has the checksum {sum}; the manifest says {}", file.blake3));
    }
    Ok(())
}
