//! `libration verify` for reports of `lab`.

use std::path::Path;

use libration_lab::ReportCheck;
use libration_report::notation::plural;
use libration_study::{Lab, StudyError};

use crate::error::Failure;
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Recomputes the studies of a report, and fails if a bit differs.
pub(super) fn run(folder: &Path, quiet: bool) -> Result<(), Failure> {
    let report = ReportCheck::read(folder).map_err(Failure::usage)?;
    let reporter = Reporter::new(quiet);
    let lab = Lab::new(report.config(), report.config().effort, &reporter, interrupt::listen());
    let (studies, others) = report.studies();
    let mut text = String::new();
    let mut differences = Vec::new();
    for (i, study) in studies.iter().enumerate() {
        lab.announce(study.name(), i + 1, studies.len());
        let checked = report.check(&lab, *study).map_err(|error| match error {
            StudyError::Interrupted => Failure::Interrupted("interrupted".to_owned()),
            error => Failure::run(format!("study `{}` failed: {error}", study.name())),
        })?;
        let verdict = match checked.differences.len() {
            0 => "same bits".to_owned(),
            n => plural(n, "difference"),
        };
        let (findings, files) =
            (plural(checked.findings, "finding"), plural(checked.files, "file"));
        text += &format!("{}: {findings}, {files}: {verdict}\n", study.name());
        differences.extend(checked.differences);
    }
    reporter.clear();
    for file in report.unknown_files() {
        text += &format!("not compared: `{file}`, which the results do not name\n");
    }
    text += "not compared: the page `report.html`, and machine and times in `results.json`\n";
    if !others.is_empty() {
        text += &format!("not recomputed, since they measure the machine: {}\n", others.join(", "));
    }
    if !quiet {
        terminal::print(&text)?;
    }
    for difference in &differences {
        terminal::error(difference);
    }
    if differences.is_empty() { Ok(()) } else { Err(Failure::Disagreement) }
}
