//! `libration lab --only`: one finding, recomputed.

use libration_lab::{STUDIES, SystemStudies};
use libration_report::record::{Agreement, Finding, Relation};
use libration_settings::suggestions::{nearest, suggest};
use libration_study::{Config, Lab, Study, StudyError};
use libration_study_motion::Problem;

use super::disagreements::check_findings;
use super::equation_file;
use crate::args::LabArgs;
use crate::error::Failure;
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Runs the study of a finding and prints the finding, without a report. Fails if it disagrees with theory.
pub(super) fn run(
    id: &str,
    args: &LabArgs,
    mut config: Config,
    quiet: bool,
) -> Result<(), Failure> {
    let name = id.split('.').next().unwrap_or(id);
    let Some(study) = STUDIES.by_name(name) else {
        let help = suggest("studies", name, STUDIES.names());
        return Err(Failure::usage(format!(
            "--only {id}: no study `{name}`; expected STUDY.NAME, the identifier of a finding; {help}"
        )));
    };
    config.studies = vec![name.to_owned()];
    let found = match &args.system {
        None => compute(study, &config, quiet)?,
        Some(file) => {
            let system = equation_file::read(file, &args.set)?;
            let problem = Problem::of_equations(&system);
            let all = SystemStudies::new(&system, &problem);
            let configured = all.configured(config);
            let (studies, config) = configured
                .map_err(|left_out| Failure::usage(left_out.sentence(&file.to_string_lossy())))?;
            match studies.first() {
                Some(study) => compute(*study, &config, quiet)?,
                None => Vec::new(),
            }
        }
    };
    let ids = || found.iter().map(|finding| finding.id.as_str());
    let Some(finding) = found.iter().find(|finding| finding.id == id) else {
        let nearest = nearest(id, ids()).map(|near| format!("did you mean `{near}`? "));
        return Err(Failure::usage(format!(
            "--only {id}: the study `{name}` has no such finding; {}`results.json` of a run of the study has all {}",
            nearest.unwrap_or_default(),
            found.len()
        )));
    };
    terminal::print(&describe(finding, study.measures_the_machine()))?;
    let mut record = libration_report::Record::new(name, study.question());
    record.find(finding.clone());
    check_findings(&[record])
}

fn compute(study: &dyn Study, config: &Config, quiet: bool) -> Result<Vec<Finding>, Failure> {
    let reporter = Reporter::new(quiet);
    let lab = Lab::new(config, config.effort, &reporter, interrupt::listen());
    let record = study.run(&lab);
    reporter.clear();
    match record {
        Ok(record) => Ok(record.findings),
        Err(StudyError::Interrupted) => Err(Failure::Interrupted("interrupted".to_owned())),
        Err(error) => Err(Failure::run(format!("study `{}` failed: {error}", study.name()))),
    }
}

/// The finding with all digits.
fn describe(finding: &Finding, is_speed: bool) -> String {
    let Finding {
        id,
        text,
        unit,
        predicted,
        measured,
        relation,
        tolerance,
        verdict,
        undecided,
        ..
    } = finding;
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    let relation = match relation {
        Relation::Equal => "",
        Relation::AtMost => "at most ",
        Relation::AtLeast => "at least ",
    };
    let mut lines = vec![format!("{id}: {text}"), format!("measured   {measured:?}{unit}")];
    let what = if is_speed { "target   " } else { "predicted" };
    lines.extend(predicted.map(|x| format!("{what}  {relation}{x:?}{unit}")));
    lines.extend(
        tolerance
            .tolerance
            .map(|x| format!("tolerance  {x:?}{unit}: {}", tolerance.tolerance_reason)),
    );
    let verdict = match verdict {
        // A speed has a target, not a prediction.
        Agreement::Agrees if is_speed => "reached".to_owned(),
        Agreement::Disagrees if is_speed => "not reached".to_owned(),
        Agreement::Agrees => "agrees".to_owned(),
        Agreement::Disagrees => "disagrees".to_owned(),
        Agreement::Measured => undecided
            .as_ref()
            .map_or("no prediction".to_owned(), |why| format!("not judged: {why}")),
    };
    lines.push(format!("verdict    {verdict}"));
    lines.join("\n") + "\n"
}
