//! The output folder of a run.

use std::fs;
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use libration_data::{DataError, LockedFile, create_file};
use thiserror::Error;

use crate::run_manifest::RunManifest;

/// The subfolder of an unfinished run.
pub const UNFINISHED: &str = "libration-unfinished";

/// The lock file of the output folder. It is not removed, since another run may wait for it.
const LOCK: &str = ".libration-lock";

/// A writable output folder that no other run uses.
///
/// A run writes into [`UNFINISHED`] and replaces the files of an earlier run at its end.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    /// Locked while it is open.
    _lock: LockedFile,
}

/// The output folder, or a file in it, cannot be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct OutputError {
    /// Path of the folder or file.
    pub path: PathBuf,
    /// Cause.
    pub source: io::Error,
}

impl Output {
    /// Opens or creates `folder` and checks that it is writable, so that a wrong path fails before the run. Completes an earlier
    /// run that was killed while it replaced files.
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
            let reason = "it is a file; expected a folder";
            return Err(failed(&aside)(io::Error::new(ErrorKind::NotADirectory, reason)));
        }
        // The run was complete, and was killed while it replaced files.
        if RunManifest::read(&aside).is_some_and(|written| written.complete) {
            output.put_in_place()?;
        }
        Ok(output)
    }

    /// Returns the path of the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the final path of the file `name`.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Returns the folder of the unfinished run.
    pub(crate) fn aside(&self) -> PathBuf {
        self.folder.join(UNFINISHED)
    }

    /// Writes the file `name` of the unfinished run atomically, and creates its folder.
    ///
    /// # Errors
    /// If a file operation fails.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        write(&self.aside().join(name), bytes)
    }

    /// Removes the unfinished run.
    ///
    /// # Errors
    /// If a file operation fails.
    pub(crate) fn clear(&self) -> Result<(), OutputError> {
        let aside = self.aside();
        absent_is_fine(fs::remove_dir_all(&aside)).map_err(failed(&aside))
    }

    /// Replaces the files of an earlier run by those of the unfinished run. Other files stay unchanged.
    ///
    /// # Errors
    /// If the file system refuses; the remaining files stay in the folder of the unfinished run.
    pub(crate) fn put_in_place(&self) -> Result<(), OutputError> {
        let results = self.aside().join("results.json");
        let new = RunManifest::read(&self.aside())
            .ok_or_else(|| failed(&results)(ErrorKind::InvalidData.into()))?
            .files();
        for file in &new {
            self.put(file)?;
        }
        let old = RunManifest::read(&self.folder).unwrap_or_default().files();
        for file in old.difference(&new) {
            remove(&self.folder.join(file))?;
        }
        // These are last: while they are not in place, the next run completes this one.
        for file in ["report.html", "results.json"] {
            self.put(Path::new(file))?;
        }
        self.clear()
    }

    /// Puts the unfinished run in place unless studies of an earlier run would be lost. Returns the folder with the
    /// unfinished run, if it has results.
    pub(crate) fn keep(&self) -> Option<PathBuf> {
        let new = RunManifest::read(&self.aside())?;
        let loses_nothing = match RunManifest::read(&self.folder) {
            Some(old) => !old.complete && old.names().is_subset(&new.names()),
            None => !["report.html", "results.json"].iter().any(|name| self.path(name).exists()),
        };
        // After a failure, report and results are still in the folder of the unfinished run.
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
                let copy = || io::copy(&mut fs::File::open(&from)?, &mut create_file(&part)?);
                let copied = copy().and_then(|_| fs::rename(&part, &to));
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
    let create = || create_file(&part)?.write_all(bytes);
    let written = create().and_then(|()| fs::rename(&part, path));
    written.map_err(failed(path))
}

/// Locks a folder.
fn lock(folder: &Path) -> Result<LockedFile, OutputError> {
    let path = folder.join(LOCK);
    LockedFile::open(&path).map_err(|error| match error {
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
