//! Reports, recomputed and compared bit by bit.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use libration_data::{read_regular, read_text_regular};
use libration_report::notation::plural;
use libration_report::page::Page;
use libration_report::record::{DataFile, FigureFile};
use libration_report::{Outcome, Record, Verdict, figure};
use libration_study::{Config, Lab, Study, StudyError};
use serde::Deserialize;
use serde_json::{Map, Value};

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
    #[serde(default)]
    figures: Vec<FigureFile>,
}

/// A study of a report, recomputed.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedStudy {
    /// The number of findings that were compared: all that are no times.
    pub findings: usize,
    /// The number of files with data and figures that were compared.
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
            read_text_regular(&file, MOST_BYTES).map_err(|error| named(error.to_string()))?;
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

    /// The files in the folders of data and figures that the results do not name.
    pub fn unknown_files(&self) -> Vec<String> {
        let files = |study: &StoredStudy| {
            let data = study.data.iter().map(|own| own.file.clone());
            data.chain(study.figures.iter().map(|own| own.file.clone())).collect::<Vec<_>>()
        };
        let known: BTreeSet<String> = self.studies.iter().flat_map(files).collect();
        let mut unknown = Vec::new();
        for inner in ["data", "figures"] {
            let entries = fs::read_dir(self.folder.join(inner)).into_iter().flatten().flatten();
            let names = entries.map(|own| format!("{inner}/{}", own.file_name().display()));
            unknown.extend(names.filter(|name| !known.contains(name)));
        }
        unknown.sort();
        unknown
    }

    /// The configuration of the run.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The studies that can be recomputed, and why each of the others cannot.
    pub fn studies(&self) -> (Vec<&'static dyn Study>, Vec<String>) {
        let (mut studies, mut others) = (Vec::<&'static dyn Study>::new(), Vec::new());
        for StoredStudy { name, .. } in &self.studies {
            match STUDIES.by_name(name) {
                None => others.push(format!("`{name}` is no study of this version")),
                Some(study) if study.measures_the_machine() => {
                    others.push(format!("`{name}` measures the machine"));
                }
                // Only the first of a name is compared.
                Some(_) if studies.iter().any(|own| own.name() == name) => {
                    others.push(format!("`{name}` is in the report twice"));
                }
                Some(study) => studies.push(study),
            }
        }
        (studies, others)
    }

    /// What a verification says, with the numbers of findings and files that were compared. Parts of a report that cannot be recomputed
    /// are no evidence.
    pub fn verdict(&self, findings: usize, files: usize, differences: usize) -> Verdict {
        let (studies, others) = self.studies();
        let compared = format!("{}, {}", plural(findings, "finding"), plural(files, "file"));
        let verdict = match (differences, others.as_slice()) {
            (0, []) if studies.is_empty() => Verdict::unknown("the report has no study"),
            (0, []) => Verdict::new(Outcome::NoFault, format!("{compared}: same bits")),
            (0, _) => Verdict::unknown(format!("not recomputed: {}", others.join(", "))),
            (n, _) => {
                let what = plural(n, "difference");
                Verdict::new(Outcome::Fault, format!("{what} in {compared}"))
            }
        };
        let unknown = self.unknown_files();
        let verdict = unknown.into_iter().fold(verdict, |verdict, file| {
            verdict.without(format!("`{file}`, which the results do not name"))
        });
        let verdict = verdict.without("the page `report.html`");
        verdict
            .without("claims, tables, machine, times, `command` and `complete` in `results.json`")
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
            |stored| compare(stored, study, &record, &self.folder),
        ))
    }
}

/// The fields that differ, with both values.
fn differing_fields(old: &Value, new: &Value) -> Vec<String> {
    let fields = [old, new].into_iter().filter_map(Value::as_object).flat_map(Map::keys);
    let differing: BTreeSet<&String> =
        fields.filter(|field| old[field.as_str()] != new[field.as_str()]).collect();
    differing
        .into_iter()
        .map(|field| format!("{field} {}, recomputed {}", old[field.as_str()], new[field.as_str()]))
        .collect()
}

/// Whether a finding is a time, which does not repeat.
fn is_time(id: &str) -> bool {
    id.ends_with(".time")
}

fn compare(
    stored: &StoredStudy,
    study: &dyn Study,
    record: &Record,
    folder: &Path,
) -> CheckedStudy {
    let mut differences = Vec::new();
    let id = |finding: &Value| finding["id"].as_str().unwrap_or_default().to_owned();
    let computed: Vec<Value> =
        record.findings.iter().filter_map(|finding| serde_json::to_value(finding).ok()).collect();
    let mut findings = 0;
    let mut known = BTreeSet::new();
    for old in stored.findings.iter().filter(|old| !known.insert(id(old))) {
        differences.push(format!("the finding `{}` is in the report twice", id(old)));
    }
    for old in stored.findings.iter().filter(|old| is_time(&id(old))) {
        if !computed.iter().any(|new| id(new) == id(old)) {
            differences.push(format!("the finding `{}` is not computed any more", id(old)));
        }
    }
    for old in stored.findings.iter().filter(|old| !is_time(&id(old))) {
        // Only a run knows it.
        let mut old = old.clone();
        old.as_object_mut().map(|fields| fields.remove("command"));
        let old = &old;
        findings += 1;
        match computed.iter().find(|new| id(new) == id(old)) {
            None => differences.push(format!("the finding `{}` is not computed any more", id(old))),
            Some(new) if new == old => {}
            Some(new) => differences.push(format!(
                "the finding `{}` differs: {}",
                id(old),
                differing_fields(old, new).join("; ")
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
    for series in record.series.iter().filter(|_| !timed) {
        if !stored.data.iter().any(|own| own.name == series.name) {
            differences.push(format!("the data `{}` are not in the report", series.name));
        }
    }
    let data = stored.data.iter().map(|DataFile { name, file }| {
        let series = record.series.iter().find(|series| series.name == *name);
        (file, series.and_then(|series| series_to_parquet(series).ok()))
    });
    let mut page = Page::default();
    let rendered = study.render(record, &mut page).is_ok();
    for figure in page.figures().filter(|_| rendered && !timed) {
        if !stored.figures.iter().any(|own| own.id == figure.id) {
            differences.push(format!("the figure `{}` is not in the report", figure.id));
        }
    }
    let figures = stored.figures.iter().map(|FigureFile { id, file }| {
        let figure = page.figures().filter(|_| rendered).find(|figure| figure.id == *id);
        (file, figure.map(|figure| figure::svg::standalone(figure).into_bytes()))
    });
    let mut files = 0;
    for (file, new) in data.chain(figures).filter(|_| !timed) {
        files += 1;
        // A longer file differs, and a device has no end.
        let most = new.as_ref().map_or(0, |new| new.len() as u64);
        match (read_regular(&folder.join(file), most), new) {
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
