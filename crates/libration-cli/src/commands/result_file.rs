//! A file of results that an option names, such as `--page`.

use std::io::{self, Write as _};
use std::path::Path;

use crate::error::Failure;
use crate::output_file::OutputFile;

/// A file that is opened before any work and written after it, if the options name one.
pub(super) struct ResultFile<'a> {
    option: &'static str,
    file: Option<(&'a Path, OutputFile)>,
}

impl<'a> ResultFile<'a> {
    /// Opens the file of an option.
    pub(super) fn create(option: &'static str, path: Option<&'a Path>) -> Result<Self, Failure> {
        let open = |path: &'a Path| match OutputFile::create(path) {
            Ok(file) => Ok((path, file)),
            Err(error) => Err(Failure::usage(unwritable(option, path, &error))),
        };
        Ok(ResultFile { option, file: path.map(open).transpose()? })
    }

    /// Whether there is a file to write.
    pub(super) fn is_wanted(&self) -> bool {
        self.file.is_some()
    }

    /// Writes the text.
    pub(super) fn write(self, text: impl FnOnce() -> String) -> Result<(), Failure> {
        let Some((path, mut file)) = self.file else { return Ok(()) };
        let written = file.write_all(text().as_bytes()).and_then(|()| file.keep());
        written.map_err(|error| Failure::run(unwritable(self.option, path, &error)))
    }
}

fn unwritable(option: &str, path: &Path, error: &io::Error) -> String {
    format!("cannot write `{}` ({option}): {error}", path.display())
}
