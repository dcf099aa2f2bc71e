//! Whether a data set is what its manifest says.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::checksum::checksum_of;
use crate::{Manifest, Stored};

/// A file that is not what the manifest says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Of which chunk.
    pub chunk: String,
    /// Which file, seen from the folder.
    pub path: PathBuf,
    /// What is wrong.
    pub what: String,
}

/// Reads all files of a data set and compares their checksums; `seen` is told after each how many bytes it had, and says whether to go on.
pub fn verify(folder: &Path, manifest: &Manifest, mut seen: impl FnMut(u64) -> bool) -> Vec<Flaw> {
    let mut flaws = Vec::new();
    for chunk in &manifest.chunks {
        for file in &chunk.files {
            if let Err(what) = sound(folder, file) {
                let (chunk, path) = (chunk.chunk.clone(), file.path.clone());
                flaws.push(Flaw { chunk, path, what });
            }
            if !seen(file.bytes) {
                return flaws;
            }
        }
    }
    flaws
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
