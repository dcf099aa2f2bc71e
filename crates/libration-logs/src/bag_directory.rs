//! Directories of ROS 2 bags.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::LogError;

/// Most files that are looked at.
const MOST: usize = 1000;
/// Files that an error lists.
const LISTED: usize = 12;

/// The only `.db3` or `.mcap` file of a directory.
pub(crate) fn file_of_bag(directory: &Path) -> Result<PathBuf, LogError> {
    let mut files: Vec<PathBuf> = fs::read_dir(directory)?
        .take(MOST)
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()?;
    files.sort_unstable();
    let is_bag = |path: &&PathBuf| {
        let ending = path.extension().and_then(|ending| ending.to_str());
        ending.is_some_and(|ending| matches!(ending, "db3" | "mcap")) && path.is_file()
    };
    let bags: Vec<&PathBuf> = files.iter().filter(is_bag).collect();
    let shown = match bags.as_slice() {
        [only] => return Ok(only.to_path_buf()),
        [] => files.iter().collect(),
        several => several.to_vec(),
    };
    let name = |path: &&PathBuf| format!("`{}`", path.file_name().unwrap_or_default().display());
    let names: Vec<String> = shown.iter().take(LISTED).map(name).collect();
    let more = match shown.len() - names.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Err(LogError::Damaged(match bags.len() {
        0 if names.is_empty() => "the directory is empty; expected a ROS 2 bag".to_owned(),
        0 => format!(
            "the directory has no .db3 or .mcap file; expected a ROS 2 bag; it has {}{more}",
            names.join(", ")
        ),
        count => format!(
            "the directory has {count} files of bags; expected one of them: {}{more}",
            names.join(", ")
        ),
    }))
}

/// Whether a text is the `metadata.yaml` of a bag.
pub(crate) fn is_metadata(text: &str) -> bool {
    text.trim_start().starts_with("rosbag2_bagfile_information:")
}
