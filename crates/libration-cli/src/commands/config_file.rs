//! Files of settings.

use std::fmt::Display;
use std::path::Path;

use libration_lab::config::ConfigError;

use crate::error::Failure;

/// What `parse` makes of the file that `--config` names.
pub(super) fn read<T>(
    path: &Path,
    parse: impl FnOnce(&str, &str) -> Result<T, ConfigError>,
) -> Result<T, Failure> {
    let wrong = |why: &dyn Display| {
        Failure::usage(format!("cannot read `{}` (--config): {why}", path.display()))
    };
    let bytes = std::fs::read(path).map_err(|error| wrong(&error))?;
    let text = String::from_utf8(bytes).map_err(|error| wrong(&error.utf8_error()))?;
    parse(&text, &path.to_string_lossy()).map_err(|error| Failure::Shown(error.render_styled()))
}
