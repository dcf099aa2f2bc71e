//! Paths in settings files.

use std::path::PathBuf;

/// A path as it stands in a file: empty where there is none.
pub fn text(path: Option<&PathBuf>) -> String {
    path.map_or_else(String::new, |path| path.display().to_string())
}

/// The path that stands in a file, if it is not empty.
pub fn of(text: String) -> Option<PathBuf> {
    Some(text).filter(|text| !text.is_empty()).map(PathBuf::from)
}
