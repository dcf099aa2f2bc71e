//! Settings files.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;

use libration_settings::{ConfigCommand, SettingsError};

use crate::error::Failure;
use crate::terminal;

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

/// Prints a note about the keys of a file that only other commands read.
pub(super) fn note_ignored_keys(text: &str, command: ConfigCommand, quiet: bool) {
    let ignored = command.ignored_keys(text);
    if quiet || ignored.is_empty() {
        return;
    }
    let mut by_reader: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (key, reader) in ignored {
        by_reader.entry(reader).or_default().push(format!("`{key}`"));
    }
    let parts = by_reader.iter().map(|(reader, keys)| format!("{} of `{reader}`", keys.join(", ")));
    let parts = parts.collect::<Vec<_>>().join("; ");
    terminal::say(&format!("note: `{}` ignores {parts}", command.name));
}
