//! Warnings about a log.

use std::path::Path;

use crate::terminal;

/// Prints the warnings about a file on stderr, and returns them with its name.
pub(super) fn warn(path: &Path, warnings: &[String]) -> Vec<String> {
    let named = |warning: &String| format!("`{}`: {warning}", path.display());
    let named: Vec<String> = warnings.iter().map(named).collect();
    named.iter().for_each(|warning| terminal::warn(warning));
    named
}
