//! Settings files.

use std::fmt::Display;
use std::path::Path;

use libration_settings::SettingsError;

use crate::error::Failure;

/// Reads and parses the file of `--config`.
pub(super) fn read<T>(
    path: &Path,
    parse: impl FnOnce(&str, &str) -> Result<T, SettingsError>,
) -> Result<T, Failure> {
    let wrong = |why: &dyn Display| {
        Failure::usage(format!("cannot read `{}` (--config): {why}", path.display()))
    };
    let text = libration_settings::read_text(path).map_err(|error| wrong(&error))?;
    parse(&text, &path.to_string_lossy()).map_err(|error| Failure::Shown(error.render_styled()))
}
