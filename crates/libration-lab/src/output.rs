//! The folder into which a run writes.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A folder that is known to take files.
#[derive(Clone, Debug)]
pub struct Output {
    folder: PathBuf,
}

/// The output folder, or a file in it, cannot be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct OutputError {
    /// What could not be written.
    pub path: PathBuf,
    /// Why.
    pub source: io::Error,
}

impl Output {
    /// Opens `folder`, creating it if need be, and tries whether it can be written: a wrong path
    /// should fail before the work and not after it.
    ///
    /// # Errors
    /// If the folder cannot be created or written.
    pub fn open(folder: impl Into<PathBuf>) -> Result<Self, OutputError> {
        let output = Output { folder: folder.into() };
        for name in [".libration", "figures/.libration", "data/.libration"] {
            output.write(name, b"")?;
            output.remove(name)?;
        }
        for name in ["report.html", "results.json"] {
            output.takes_a_file(output.path(name))?;
        }
        for name in ["figures", "data"] {
            let path = output.path(name);
            let entries = fs::read_dir(&path).map_err(|source| OutputError { path, source })?;
            let written = |path: &PathBuf| path.extension().is_some();
            let paths = entries.flatten().map(|entry| entry.path());
            paths.filter(written).try_for_each(|path| output.takes_a_file(path))?;
        }
        Ok(output)
    }

    /// Fails if there is a folder where a file is to be.
    fn takes_a_file(&self, path: PathBuf) -> Result<(), OutputError> {
        if !path.is_dir() {
            return Ok(());
        }
        let reason = "it is a folder, but it must be a file";
        Err(OutputError { path, source: io::Error::new(io::ErrorKind::IsADirectory, reason) })
    }

    /// Removes the file `name`, if there is one.
    ///
    /// # Errors
    /// If the file system refuses.
    pub fn remove(&self, name: &str) -> Result<(), OutputError> {
        let path = self.path(name);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(OutputError { path, source })
            }
            _ => Ok(()),
        }
    }

    /// The folder itself.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The path of the file `name` in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes the file `name`, whole or not at all, creating the folders on its way.
    ///
    /// # Errors
    /// If the file system refuses.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        let path = self.path(name);
        let failed = |source| OutputError { path: path.clone(), source };
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(failed)?;
        }
        let mut temporary = path.clone().into_os_string();
        temporary.push(".part");
        fs::write(&temporary, bytes).map_err(failed)?;
        fs::rename(&temporary, &path).map_err(failed)
    }
}
