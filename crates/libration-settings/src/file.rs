//! Settings files.

use std::io;
use std::path::Path;

use libration_data::{read_bounded, read_text_bounded};

use super::limits::SETTINGS_BYTES;

/// The bytes of a settings file.
///
/// # Errors
/// If the file cannot be read, or is longer than [`SETTINGS_BYTES`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    read_bounded(path, SETTINGS_BYTES)
}

/// The text of a settings file.
///
/// # Errors
/// Those of [`read`], and if the file is not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    read_text_bounded(path, SETTINGS_BYTES)
}
