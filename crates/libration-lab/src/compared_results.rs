//! Results of `lab` in a file, as a comparison reads them.

use std::collections::HashSet;
use std::io;
use std::path::Path;

use libration_data::{read_text_bounded, read_text_regular};
use libration_report::Record;
use libration_report::record::{Claim, Finding};
use serde::Deserialize;

use crate::results::SCHEMA;

/// The part of a file with results that a comparison needs.
#[derive(Clone, Debug, Deserialize)]
pub struct ComparedResults {
    #[serde(default = "yes")]
    pub(crate) complete: bool,
    #[serde(default)]
    pub(crate) machine: serde_json::Map<String, serde_json::Value>,
    #[serde(default)]
    pub(crate) config: serde_json::Map<String, serde_json::Value>,
    pub(crate) studies: Vec<Record>,
}

/// Bytes of the longest file that is read.
const MOST_BYTES: u64 = 1 << 28;

impl ComparedResults {
    /// The text of a file of results.
    ///
    /// # Errors
    /// If it cannot be read, is longer than 256 MiB, or is not UTF-8.
    pub fn read_text(file: &Path) -> io::Result<String> {
        // The output of a program is a pipe of the shell there; a pipe elsewhere has no writer.
        match file.starts_with("/dev") || file.starts_with("/proc") {
            true => read_text_bounded(file, MOST_BYTES),
            false => read_text_regular(file, MOST_BYTES),
        }
    }

    /// The results in the text of a file `results.json`.
    ///
    /// # Errors
    /// A sentence that says what is wrong: no JSON, other JSON, or another version of the format.
    pub fn parse(text: &str) -> Result<Self, String> {
        let value: serde_json::Value =
            serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
        match value.get("schema").and_then(serde_json::Value::as_str) {
            Some(SCHEMA) => {}
            Some(other) => return Err(format!("its schema is `{other}`; expected `{SCHEMA}`")),
            None => {
                return Err(format!(
                    "it has no schema; expected `{SCHEMA}`, a file of `libration lab`"
                ));
            }
        }
        let results: Self = serde_json::from_value(value)
            .map_err(|error| format!("no results of `libration lab`: {error}"))?;
        let claims = results.claims().map(|(_, claim)| claim.id.as_str());
        first_repeated("finding", results.findings().map(|finding| finding.id.as_str()))?;
        first_repeated("claim", claims)?;
        Ok(results)
    }

    /// Whether all studies of the run are there.
    pub(crate) fn is_complete(&self) -> bool {
        self.complete
    }

    /// Whether these results should have a finding or claim of a study that others have: with the same settings but for the studies, and this
    /// study among them.
    pub(crate) fn should_have(&self, other: &Self, id: &str) -> bool {
        let settings = |results: &Self| {
            let mut config = results.config.clone();
            config.remove("studies");
            config
        };
        let study = id.split('.').next().unwrap_or_default();
        let chosen = self.config.get("studies").and_then(serde_json::Value::as_array);
        let is_chosen = chosen.is_none_or(|names| {
            names.is_empty() || names.iter().any(|name| name.as_str() == Some(study))
        });
        is_chosen && settings(self) == settings(other)
    }

    /// The claims, each with the name of its study.
    pub(crate) fn claims(&self) -> impl Iterator<Item = (&str, &Claim)> + Clone {
        self.studies
            .iter()
            .flat_map(|record| record.claims.iter().map(|claim| (record.name.as_str(), claim)))
    }

    /// All findings.
    pub(crate) fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.studies.iter().flat_map(|record| &record.findings)
    }
}

fn yes() -> bool {
    true
}

/// Fails for an identifier that occurs twice: one of the two would be compared, by the order of the file.
fn first_repeated<'a>(what: &str, ids: impl Iterator<Item = &'a str>) -> Result<(), String> {
    let mut known = HashSet::new();
    for id in ids {
        if !known.insert(id) {
            return Err(format!("the {what} `{id}` occurs twice; expected each identifier once"));
        }
    }
    Ok(())
}
