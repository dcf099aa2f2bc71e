//! The files of a run, from its `results.json`.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use libration_data::read_regular;
use serde::Deserialize;

use crate::results::SCHEMA;

/// Largest size of a `results.json` in bytes; that of all studies has one or two million.
const LIMIT: u64 = 1 << 28;

/// The studies and files of a run.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct RunManifest {
    schema: String,
    /// Whether all requested studies are included.
    pub(crate) complete: bool,
    studies: Vec<ManifestStudy>,
}

#[derive(Debug, Deserialize)]
struct ManifestStudy {
    name: String,
    figures: Vec<ManifestFile>,
    /// Missing in earlier versions.
    #[serde(default)]
    data: Vec<ManifestFile>,
}

#[derive(Debug, Deserialize)]
struct ManifestFile {
    file: PathBuf,
}

impl RunManifest {
    /// Reads the `results.json` of a folder, if this program wrote it.
    pub(crate) fn read(folder: &Path) -> Option<Self> {
        let bytes = read_regular(&folder.join("results.json"), LIMIT).ok()?;
        let written: RunManifest = serde_json::from_slice(&bytes).ok()?;
        (written.schema == SCHEMA).then_some(written)
    }

    /// Returns the paths of figures and data; a run writes no other folders.
    pub(crate) fn files(&self) -> BTreeSet<PathBuf> {
        let files = self.studies.iter().flat_map(|study| study.figures.iter().chain(&study.data));
        files.map(|file| file.file.clone()).filter(|file| is_written(file)).collect()
    }

    /// Returns the names of the studies.
    pub(crate) fn names(&self) -> BTreeSet<&str> {
        self.studies.iter().map(|study| study.name.as_str()).collect()
    }
}

/// Whether a run writes files to this path.
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
