//! The file of `--page`.

use std::io::{self, Write as _};
use std::path::Path;

use crate::error::Failure;
use crate::output_file::OutputFile;

/// The file of `--page`, which is opened before any work and written after it.
pub(super) struct PageFile<'a>(Option<(&'a Path, OutputFile)>);

impl<'a> PageFile<'a> {
    /// Opens the file, if the options name one.
    pub(super) fn create(path: Option<&'a Path>) -> Result<Self, Failure> {
        let open = |path: &'a Path| match OutputFile::create(path) {
            Ok(file) => Ok((path, file)),
            Err(error) => Err(Failure::usage(unwritable(path, &error))),
        };
        path.map(open).transpose().map(PageFile)
    }

    /// Writes the page.
    pub(super) fn write(self, page: impl FnOnce() -> String) -> Result<(), Failure> {
        let Some((path, mut file)) = self.0 else { return Ok(()) };
        let written = file.write_all(page().as_bytes()).and_then(|()| file.keep());
        written.map_err(|error| Failure::run(unwritable(path, &error)))
    }
}

fn unwritable(path: &Path, error: &io::Error) -> String {
    format!("cannot write `{}` (--page): {error}", path.display())
}
