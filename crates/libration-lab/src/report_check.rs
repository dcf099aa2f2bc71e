//! Reports, recomputed and compared bit by bit.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use libration_data::{read_bounded, read_text_bounded};
use libration_report::Record;
use libration_report::record::DataFile;
use libration_study::{Config, Lab, Study, StudyError};
use serde::Deserialize;
use serde_json::Value;

use crate::STUDIES;
use crate::results::SCHEMA;
use crate::series::series_to_parquet;

/// The most bytes of `results.json`.
const MOST_BYTES: u64 = 1 << 30;

/// A report to recompute.
pub struct ReportCheck {
    folder: PathBuf,
    config: Config,
    studies: Vec<StoredStudy>,
}

/// The part of `results.json` that is recomputed.
#[derive(Deserialize)]
struct Stored {
    schema: String,
    config: Value,
    system: Option<Value>,
    studies: Vec<StoredStudy>,
}

#[derive(Deserialize)]
struct StoredStudy {
    name: String,
    findings: Vec<Value>,
    data: Vec<DataFile>,
}

/// A study of a report, recomputed.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedStudy {
    /// The number of findings that were compared: all that are no times.
    pub findings: usize,
    /// The number of data files that were compared.
    pub files: usize,
    /// Each finding and file that differs, in words.
    pub differences: Vec<String>,
}

impl ReportCheck {
    /// Whether a folder has results of `lab`.
    pub fn is_report(folder: &Path) -> bool {
        folder.join("results.json").is_file()
    }

    /// Reads the results in a folder.
    ///
    /// # Errors
    /// A sentence: no results, results of another version, or of a system in a file of its own.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let file = folder.join("results.json");
        let named = |reason: String| format!("`{}`: {reason}", file.display());
        let text =
            read_text_bounded(&file, MOST_BYTES).map_err(|error| named(error.to_string()))?;
        let stored: Stored =
            serde_json::from_str(&text).map_err(|error| named(error.to_string()))?;
        if stored.schema != SCHEMA {
            return Err(named(format!(
                "results of the format {}; expected {SCHEMA}",
                stored.schema
            )));
        }
        if stored.system.is_some() {
            let reason = "results of a system in a file of its own, which they do not contain; help: repeat the run and use `libration compare`";
            return Err(named(reason.to_owned()));
        }
        let config = STUDIES.parse_json(&stored.config).map_err(|error| {
            named(format!("the configuration is not one of this version: {error}"))
        })?;
        Ok(ReportCheck { folder: folder.to_owned(), config, studies: stored.studies })
    }

    /// The configuration of the run.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The studies that can be recomputed, and the names of those that measure the machine.
    pub fn studies(&self) -> (Vec<&'static dyn Study>, Vec<&str>) {
        let (mut studies, mut others) = (Vec::new(), Vec::new());
        for stored in &self.studies {
            match STUDIES.by_name(&stored.name) {
                Some(study) if !study.measures_the_machine() => studies.push(study),
                _ => others.push(stored.name.as_str()),
            }
        }
        (studies, others)
    }

    /// Recomputes a study and compares all findings but times, and all data files.
    ///
    /// # Errors
    /// That of the study.
    pub fn check(&self, lab: &Lab<'_>, study: &dyn Study) -> Result<CheckedStudy, StudyError> {
        let record = study.run(lab)?;
        let stored = self.studies.iter().find(|stored| stored.name == study.name());
        Ok(stored.map_or_else(
            || CheckedStudy { findings: 0, files: 0, differences: Vec::new() },
            |stored| compare(stored, &record, &self.folder),
        ))
    }
}

/// Whether a finding is a time, which does not repeat.
fn is_time(id: &str) -> bool {
    id.ends_with(".time")
}

fn compare(stored: &StoredStudy, record: &Record, folder: &Path) -> CheckedStudy {
    let mut differences = Vec::new();
    let id = |finding: &Value| finding["id"].as_str().unwrap_or_default().to_owned();
    let computed: Vec<Value> =
        record.findings.iter().filter_map(|finding| serde_json::to_value(finding).ok()).collect();
    let mut findings = 0;
    for old in stored.findings.iter().filter(|old| !is_time(&id(old))) {
        findings += 1;
        match computed.iter().find(|new| id(new) == id(old)) {
            None => differences.push(format!("the finding `{}` is not computed any more", id(old))),
            Some(new) if new == old => {}
            Some(new) => differences.push(format!(
                "the finding `{}` differs: measured {}, recomputed {}; predicted {}, recomputed {}",
                id(old),
                old["measured"],
                new["measured"],
                old["predicted"],
                new["predicted"]
            )),
        }
    }
    for new in computed.iter().filter(|new| !is_time(&id(new))) {
        if !stored.findings.iter().any(|old| id(old) == id(new)) {
            differences.push(format!("the finding `{}` is not in the report", id(new)));
        }
    }
    // A study that also measures times has them in its data.
    let timed = stored.findings.iter().any(|finding| is_time(&id(finding)));
    let mut files = 0;
    for DataFile { name, file } in stored.data.iter().filter(|_| !timed) {
        files += 1;
        let series = record.series.iter().find(|series| series.name == *name);
        let new = series.and_then(|series| series_to_parquet(series).ok());
        // A longer file differs, and a device has no end.
        let most = new.as_ref().map_or(0, |new| new.len() as u64);
        match (read_bounded(&folder.join(file), most), new) {
            (Ok(old), Some(new)) if old == new => {}
            (Err(error), _) if error.kind() == ErrorKind::FileTooLarge => {
                differences.push(format!("the file `{file}` differs"));
            }
            (Ok(_), _) => differences.push(format!("the file `{file}` differs")),
            (Err(error), _) => {
                differences.push(format!("the file `{file}` cannot be read: {error}"))
            }
        }
    }
    CheckedStudy { findings, files, differences }
}
