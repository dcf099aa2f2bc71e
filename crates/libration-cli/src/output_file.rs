//! A file that is written whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process;

/// A file under a temporary name beside its own, until it is complete.
///
/// What exists and is no regular file (a pipe, `/dev/null`) is written to directly.
#[derive(Debug)]
pub(crate) struct OutputFile {
    file: File,
    /// The temporary name, and the name that it is to get.
    rename: Option<(PathBuf, PathBuf)>,
}

impl OutputFile {
    /// Opens the file that will become `path`.
    ///
    /// # Errors
    /// If `path` cannot be written, or is a folder.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        // Follows links, so that what they point to is replaced and not the link.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if target.exists() {
            // A file that the user made read-only stays as it is.
            let file = OpenOptions::new().write(true).open(&target)?;
            if !file.metadata()?.is_file() {
                return Ok(OutputFile { file, rename: None });
            }
        }
        let name = target.file_name().ok_or(io::ErrorKind::IsADirectory)?;
        let mut temporary = OsString::from(".");
        temporary.push(name);
        temporary.push(format!(".{}.part", process::id()));
        let temporary = target.with_file_name(temporary);
        let file = OpenOptions::new().write(true).create_new(true).open(&temporary)?;
        Ok(OutputFile { file, rename: Some((temporary, target)) })
    }

    /// Gives the complete file its name.
    ///
    /// # Errors
    /// If the file system refuses; the temporary file is then gone.
    pub(crate) fn keep(mut self) -> io::Result<()> {
        self.file.flush()?;
        if let Some((temporary, target)) = &self.rename {
            fs::rename(temporary, target)?;
        }
        self.rename = None;
        Ok(())
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        if let Some((temporary, _)) = &self.rename {
            // It is rubbish; there is nobody to tell that it stays.
            let _ = fs::remove_file(temporary);
        }
    }
}
