//! The folder into which a run writes.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use libration_data::{DataError, open_locked};
use thiserror::Error;

use crate::written::Written;

/// The folder in the output folder that holds an unfinished run, and nothing else.
pub const UNFINISHED: &str = "libration-unfinished";

/// The file in the output folder that a run locks. It stays, since another run may wait for it.
const LOCK: &str = ".libration-lock";

/// A folder that is known to take files, and that no other run uses.
///
/// A run writes aside, into [`UNFINISHED`]: what an earlier run left is replaced when a later one ends.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    /// Locked as long as it is open.
    _lock: File,
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
    /// should fail before the work and not after it. Ends what an earlier run was killed in.
    ///
    /// # Errors
    /// If the folder cannot be created or written, or another run uses it.
    pub fn open(folder: impl Into<PathBuf>) -> Result<Self, OutputError> {
        let folder = folder.into();
        fs::create_dir_all(&folder).map_err(failed(&folder))?;
        let output = Output { _lock: lock(&folder)?, folder };
        for name in [".libration", "figures/.libration", "data/.libration"] {
            write(&output.path(name), b"")?;
            remove(&output.path(name))?;
        }
        for name in ["report.html", "results.json"] {
            takes_a_file(&output.path(name))?;
        }
        for name in ["figures", "data"] {
            let path = output.path(name);
            let entries = fs::read_dir(&path).map_err(failed(&path))?;
            let written = |path: &PathBuf| path.extension().is_some();
            let paths = entries.flatten().map(|entry| entry.path());
            paths.filter(written).try_for_each(|path| takes_a_file(&path))?;
        }
        let aside = output.aside();
        if aside.exists() && !aside.is_dir() {
            let reason = "it is a file, but it must be a folder";
            return Err(failed(&aside)(io::Error::new(ErrorKind::NotADirectory, reason)));
        }
        // Its run had ended, and was killed while it replaced files.
        if Written::read(&aside).is_some_and(|written| written.complete) {
            output.put_in_place()?;
        }
        Ok(output)
    }

    /// The folder itself.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The path of the file `name` in the folder, where it lies when the run has ended.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The folder of the unfinished run.
    pub(crate) fn aside(&self) -> PathBuf {
        self.folder.join(UNFINISHED)
    }

    /// Writes the file `name` of the unfinished run, whole or not at all, creating the folders on its way.
    ///
    /// # Errors
    /// If the file system refuses.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        write(&self.aside().join(name), bytes)
    }

    /// Removes the unfinished run, of whichever run it is.
    ///
    /// # Errors
    /// If the file system refuses.
    pub(crate) fn clear(&self) -> Result<(), OutputError> {
        let aside = self.aside();
        absent_is_fine(fs::remove_dir_all(&aside)).map_err(failed(&aside))
    }

    /// Replaces what an earlier run wrote by the unfinished run. No other file is touched.
    ///
    /// # Errors
    /// If the file system refuses; what is not yet in place then still lies aside.
    pub(crate) fn put_in_place(&self) -> Result<(), OutputError> {
        let results = self.aside().join("results.json");
        let new = Written::read(&self.aside())
            .ok_or_else(|| failed(&results)(ErrorKind::InvalidData.into()))?
            .files();
        for file in &new {
            self.put(file)?;
        }
        let old = Written::read(&self.folder).unwrap_or_default().files();
        for file in old.difference(&new) {
            remove(&self.folder.join(file))?;
        }
        // The last to go: while it lies aside, a run that is killed is ended by the next one.
        for file in ["report.html", "results.json"] {
            self.put(Path::new(file))?;
        }
        self.clear()
    }

    /// Puts the unfinished run in place if no study of an earlier run is lost by that. Gives the folder that holds it then,
    /// if there is any of it.
    pub(crate) fn keep(&self) -> Option<PathBuf> {
        let new = Written::read(&self.aside())?;
        let loses_nothing = match Written::read(&self.folder) {
            Some(old) => !old.complete && old.names().is_subset(&new.names()),
            None => !["report.html", "results.json"].iter().any(|name| self.path(name).exists()),
        };
        // Where that fails, its report and its results are still aside.
        let in_place = loses_nothing && self.put_in_place().is_ok();
        Some(if in_place { self.folder.clone() } else { self.aside() })
    }

    /// Puts a file of the unfinished run in place, if it is not there already.
    fn put(&self, name: &Path) -> Result<(), OutputError> {
        let (from, to) = (self.aside().join(name), self.folder.join(name));
        match fs::rename(&from, &to) {
            // A folder of it may be a link to another disk.
            Err(error) if error.kind() == ErrorKind::CrossesDevices => {
                let part = part(&to);
                let copied = fs::copy(&from, &part).and_then(|_| fs::rename(&part, &to));
                copied.and_then(|()| fs::remove_file(&from)).map_err(failed(&to))
            }
            outcome => absent_is_fine(outcome).map_err(failed(&to)),
        }
    }
}

/// Writes a file, whole or not at all, creating the folders on its way.
fn write(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(failed(path))?;
    }
    let part = part(path);
    let written = fs::write(&part, bytes).and_then(|()| fs::rename(&part, path));
    written.map_err(failed(path))
}

/// Locks a folder.
fn lock(folder: &Path) -> Result<File, OutputError> {
    let path = folder.join(LOCK);
    open_locked(&path).map_err(|error| match error {
        DataError::Io { source, .. } => failed(&path)(source),
        _ => {
            let reason = "another run writes there; wait for it, or choose another folder";
            failed(folder)(io::Error::new(ErrorKind::ResourceBusy, reason))
        }
    })
}

/// The name that a file has until it is whole.
fn part(path: &Path) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    part.into()
}

/// Removes a file, if there is one.
fn remove(path: &Path) -> Result<(), OutputError> {
    absent_is_fine(fs::remove_file(path)).map_err(failed(path))
}

fn absent_is_fine(outcome: io::Result<()>) -> io::Result<()> {
    outcome.or_else(|error| if error.kind() == ErrorKind::NotFound { Ok(()) } else { Err(error) })
}

/// Fails if there is a folder where a file is to be.
fn takes_a_file(path: &Path) -> Result<(), OutputError> {
    if !path.is_dir() {
        return Ok(());
    }
    let reason = "it is a folder, but it must be a file";
    Err(failed(path)(io::Error::new(ErrorKind::IsADirectory, reason)))
}

fn failed(path: &Path) -> impl Fn(io::Error) -> OutputError {
    let path = path.to_owned();
    move |source| OutputError { path: path.clone(), source }
}
