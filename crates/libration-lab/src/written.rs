//! The files of a run, as its `results.json` names them.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use libration_data::read_bounded;
use serde::Deserialize;

use crate::results::SCHEMA;

/// Bytes of the longest `results.json` that is looked into: that of all studies has one or two million.
const LIMIT: u64 = 1 << 28;

/// What a run wrote.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct Written {
    schema: String,
    /// Whether all studies that were asked for are in it.
    pub(crate) complete: bool,
    studies: Vec<WrittenStudy>,
}

#[derive(Debug, Deserialize)]
struct WrittenStudy {
    name: String,
    figures: Vec<WrittenFile>,
    /// Earlier versions did not name them.
    #[serde(default)]
    data: Vec<WrittenFile>,
}

#[derive(Debug, Deserialize)]
struct WrittenFile {
    file: PathBuf,
}

impl Written {
    /// What the `results.json` of a folder says, if it has one of this program.
    pub(crate) fn read(folder: &Path) -> Option<Self> {
        let bytes = read_bounded(&folder.join("results.json"), LIMIT).ok()?;
        let written: Written = serde_json::from_slice(&bytes).ok()?;
        (written.schema == SCHEMA).then_some(written)
    }

    /// Its figures and data. What lies elsewhere was never written by a run.
    pub(crate) fn files(&self) -> BTreeSet<PathBuf> {
        let files = self.studies.iter().flat_map(|study| study.figures.iter().chain(&study.data));
        files.map(|file| file.file.clone()).filter(|file| is_written(file)).collect()
    }

    /// The names of its studies.
    pub(crate) fn names(&self) -> BTreeSet<&str> {
        self.studies.iter().map(|study| study.name.as_str()).collect()
    }
}

/// Whether a run writes files of that path.
fn is_written(path: &Path) -> bool {
    let mut parts = path.components();
    let folder = parts.next().map(Component::as_os_str);
    let in_place = folder.is_some_and(|folder| folder == "figures" || folder == "data");
    in_place && matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_path_leads_out_of_the_folders_of_figures_and_data() {
        for (path, written) in [
            ("figures/a.svg", true),
            ("data/a.parquet", true),
            ("data", false),
            ("data/..", false),
            ("data/../a", false),
            ("data/a/b", false),
            ("../data/a", false),
            ("/data/a", false),
            ("notes/a", false),
        ] {
            assert_eq!(is_written(Path::new(path)), written, "{path}");
        }
    }
}
