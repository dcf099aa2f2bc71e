//! `libration lab`.

use std::fmt::Write;
use std::path::Path;

use libration_lab::output::{Output, OutputError};
use libration_lab::results::Results;
use libration_lab::session::{Cause, SessionError};
use libration_lab::{STUDIES, SystemStudies, session};
use libration_report::record::{Agreement, Record};
use libration_settings::ConfigCommand;
use libration_study::{Config, Lab};
use libration_study_motion::Problem;

use super::disagreements::check_findings;
use super::{config_file, equation_file, finding};
use crate::args::{LabArgs, quoted, simd};
use crate::error::Failure;
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Runs studies and writes a report, or prints the configuration or its schema.
pub(crate) fn run(args: &LabArgs, quiet: bool) -> Result<(), Failure> {
    if args.print_config {
        return Ok(terminal::print(&STUDIES.text())?);
    }
    if args.schema {
        return Ok(terminal::print(&format!("{:#}\n", STUDIES.schema()))?);
    }
    let config = configure(args, quiet)?;
    if let Some(id) = &args.only {
        return finding::run(id, args, config, quiet);
    }
    let reporter = Reporter::new(quiet);
    let open = || Output::open(&args.out).map_err(|error| unwritable(&args.out, &error));
    let (results, output) = match &args.system {
        None => {
            let output = open()?;
            let command = of_settings(args);
            let run =
                |lab: &Lab<'_>| session::run_as(&command, lab, &STUDIES.chosen(&config), &output);
            (investigate(&config, &reporter, run)?, output)
        }
        Some(file) => {
            let system = equation_file::read(file, &args.set)?;
            let problem = Problem::of_equations(&system);
            let name = file.to_string_lossy();
            let all = SystemStudies::new(&system, &problem);
            let all = all.with_command(&name, &args.set, args.effort);
            let configured = all.configured(config);
            let (studies, config) =
                configured.map_err(|left_out| Failure::usage(left_out.sentence(&name)))?;
            let output = open()?;
            let run = |lab: &Lab<'_>| session::run_system(lab, &all, &studies, &output);
            (investigate(&config, &reporter, run)?, output)
        }
    };
    let report = output.path("report.html");
    if !quiet {
        terminal::print(&summary(&results, &report))?;
    }
    if args.open {
        show(&report);
    }
    check_findings(&results.studies)
}

/// The command of the same run, without names of studies and the options of its output.
fn of_settings(args: &LabArgs) -> String {
    let config = args
        .config
        .iter()
        .flat_map(|path| ["--config".to_owned(), path.to_string_lossy().into_owned()]);
    let effort =
        args.effort.iter().flat_map(|effort| ["--effort", effort.name()].map(str::to_owned));
    quoted(
        ["libration", "lab"].map(str::to_owned).into_iter().chain(config).chain(effort).collect(),
    )
}

/// Opens the report in the browser. A failure is only a warning.
fn show(report: &Path) {
    // Some of these programs start in another folder.
    if let Err(error) = report.canonicalize().and_then(open::that_detached) {
        terminal::warn(&format!("cannot show `{}` (--open): {error}", report.display()));
    }
}

/// Returns the configuration of the file, with options in place of its values.
fn configure(args: &LabArgs, quiet: bool) -> Result<Config, Failure> {
    let mut config = match &args.config {
        Some(path) => read(path, quiet)?,
        None => STUDIES.config(),
    };
    if args.all {
        config.studies = STUDIES.names().into_iter().map(str::to_owned).collect();
    } else if !args.studies.is_empty() {
        config.studies.clone_from(&args.studies);
    }
    config.effort = args.effort.unwrap_or(config.effort);
    config.simd = simd::instruction_set(args.simd)?.or(config.simd);
    STUDIES.check(&config).map_err(Failure::usage)?;
    Ok(config)
}

fn read(path: &Path, quiet: bool) -> Result<Config, Failure> {
    let bytes = libration_settings::read(path).map_err(|error| {
        Failure::usage(format!("cannot read `{}` (--config): {error}", path.display()))
    })?;
    let config = STUDIES
        .parse_bytes(&bytes, &path.to_string_lossy())
        .map_err(|error| Failure::Shown(error.render_styled()))?;
    let text = String::from_utf8_lossy(&bytes);
    config_file::note_ignored_keys(&text, ConfigCommand::LAB, quiet);
    Ok(config)
}

fn unwritable(folder: &Path, error: &OutputError) -> Failure {
    let reason = if folder.is_file() {
        "it is a file; expected a folder".to_owned()
    } else {
        format!("`{}`: {}", error.path.display(), error.source)
    };
    Failure::usage(format!("cannot write into the folder `{}` (--out): {reason}", folder.display()))
}

fn investigate(
    config: &Config,
    reporter: &Reporter,
    run: impl FnOnce(&Lab<'_>) -> Result<Results, SessionError>,
) -> Result<Results, Failure> {
    let stop = interrupt::listen();
    let results = run(&Lab::new(config, config.effort, reporter, stop));
    reporter.clear();
    results.map_err(|error| match *error.cause {
        Cause::Interrupted => Failure::Interrupted(error.to_string()),
        _ => Failure::run(error),
    })
}

/// Returns one line per study, and the path of the report.
fn summary(results: &Results, report: &Path) -> String {
    let width = results.studies.iter().map(|r| r.name.len()).chain(["study".len()]).max();
    let width = width.unwrap_or_default();
    let mut text = format!(
        "{:width$}  {:>14}  {:>6}  {:>7}\n",
        "study", "findings agree", "claims", "seconds"
    );
    for record in &results.studies {
        let (name, claims, seconds) = (&record.name, record.claims.len(), record.seconds);
        let agree = agreement(record);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:width$}  {agree:>14}  {claims:>6}  {seconds:>7.1}");
    }
    let _ = writeln!(text, "\nreport: {}", report.display());
    text
}

/// Returns how many findings with a prediction agree.
fn agreement(record: &Record) -> String {
    let predicted = record.findings.iter().filter(|f| f.verdict != Agreement::Measured);
    let agree = record.findings.iter().filter(|f| f.agrees()).count();
    format!("{agree} of {}", predicted.count())
}

#[cfg(test)]
mod tests {
    use libration_report::record::{Finding, Tolerance};
    use libration_study::Machine;

    use super::*;

    /// Two studies; a finding of the second agrees with theory.
    fn results() -> Results {
        let mut first = Record::new("spectrum", "?");
        first.find(Finding::measured("spectrum.x", "", "s", 3.0));
        let mut second = Record::new("drift", "?");
        let tolerance = Tolerance::absolute(1e-6, "rounding");
        let finding = Finding::predicted("drift.rk4", "drift of RK4", "J", 1.0, 1.0, tolerance);
        second.find(finding);
        second.seconds = 12.345;
        Results {
            command: "libration lab".to_owned(),
            schema: libration_lab::results::SCHEMA,
            machine: Machine::detect(),
            config: STUDIES.config(),
            system: None,
            seconds: 13.0,
            complete: true,
            claims_without_study: &[],
            unjudged: Vec::new(),
            not_applicable: Vec::new(),
            studies: vec![first, second],
        }
    }

    #[test]
    fn the_summary_has_a_line_for_each_study_and_names_the_report() {
        let expected = "\
study     findings agree  claims  seconds
spectrum          0 of 0       0      0.0
drift             1 of 1       0     12.3

report: out/report.html
";
        assert_eq!(summary(&results(), Path::new("out/report.html")), expected);
    }
}
