//! Optional paths in settings files: an empty text stands for no path.

use std::path::PathBuf;

/// The text of an optional path; empty without one.
pub fn to_text(path: Option<&PathBuf>) -> String {
    path.map_or_else(String::new, |path| path.display().to_string())
}

/// The path in a text; none if the text is empty.
pub fn from_text(text: String) -> Option<PathBuf> {
    Some(text).filter(|text| !text.is_empty()).map(PathBuf::from)
}
