//! `libration verify` for reports of `lab`.

use std::path::Path;

use libration_lab::ReportCheck;
use libration_report::notation::plural;
use libration_report::printable::printable;
use libration_report::verdict::{GOOD, exit_code};
use libration_study::{Lab, StudyError};

use crate::error::Failure;
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Recomputes the studies of a report, and fails if a bit differs or a study cannot be recomputed.
pub(super) fn run(folder: &Path, quiet: bool) -> Result<(), Failure> {
    let report = ReportCheck::read(folder).map_err(Failure::usage)?;
    let reporter = Reporter::new(quiet);
    let lab = Lab::new(report.config(), report.config().effort, &reporter, interrupt::listen());
    let (studies, _) = report.studies();
    let (mut findings, mut files) = (0, 0);
    let mut text = String::new();
    let mut differences = Vec::new();
    for (i, study) in studies.iter().enumerate() {
        lab.announce(study.name(), i + 1, studies.len());
        let checked = report.check(&lab, *study).map_err(|error| match error {
            StudyError::Interrupted => Failure::Interrupted("interrupted".to_owned()),
            error => Failure::run(format!("study `{}` failed: {error}", study.name())),
        })?;
        let result = match checked.differences.len() {
            0 => "same bits".to_owned(),
            n => plural(n, "difference"),
        };
        (findings, files) = (findings + checked.findings, files + checked.files);
        let [own_findings, own_files] = [(checked.findings, "finding"), (checked.files, "file")]
            .map(|(n, what)| plural(n, what));
        text += &format!("{}: {own_findings}, {own_files}: {result}\n", study.name());
        differences.extend(checked.differences);
    }
    reporter.clear();
    let verdict = report.verdict(findings, files, differences.len());
    let answer = match verdict.is_good() {
        true => format!("The report is verified: {}.", verdict.evidence),
        false => format!("The report is not verified: {}: {}.", verdict.outcome, verdict.evidence),
    };
    let limits = verdict.limits();
    if !quiet || !verdict.is_good() {
        terminal::print(&format!("{}\n{}\n{text}", printable(&answer), printable(&limits)))?;
    }
    for difference in &differences {
        terminal::error(difference);
    }
    match exit_code([&verdict]) {
        GOOD => Ok(()),
        _ => Err(Failure::Disagreement),
    }
}
