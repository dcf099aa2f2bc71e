//! A temporary folder.

use std::path::{Path, PathBuf};
use std::{env, fs, process};

/// An empty folder that vanishes with this value.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// A new folder; `name` tells apart those of one process.
    pub(crate) fn new(name: &str) -> Result<Self, String> {
        let path = env::temp_dir().join(format!("libration-xtask-{}-{name}", process::id()));
        fs::create_dir_all(&path)
            .map_err(|error| format!("{} cannot be made: {error}", path.display()))?;
        Ok(Scratch(path))
    }

    /// Returns the path.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // Nobody depends on the folder being gone.
        let _ = fs::remove_dir_all(&self.0);
    }
}
