//! A run of the laboratory: studies in turn, each written to disk as it ends.

use std::path::{Path, PathBuf};
use std::time::Instant;

use thiserror::Error;

pub use crate::series::series_to_parquet;
use libration_data::TableError;
use libration_report::page::{Chapter, Page};
use libration_report::record::{DataFile, FigureFile, RecordError, Series};
use libration_study::StudyError;

use crate::output::{Output, OutputError};
use crate::report_cover::cover;
use crate::results::{Results, SCHEMA};
use crate::system_studies::{SYSTEM_OPTION, SystemStudies};
pub use crate::unjudged_claims::unjudged;
use libration_report::{Record, figure, report};
use libration_study::{Config, Effort, Lab, Machine, Study};

use crate::claims_without_study::CLAIMS_WITHOUT_STUDY;

/// Error of a run that ended early.
#[derive(Debug, Error)]
#[error("{cause}; {}", kept_in(kept.as_deref()))]
pub struct SessionError {
    /// Cause.
    #[source]
    pub cause: Box<Cause>,
    /// Folder with the completed studies, if any.
    pub kept: Option<PathBuf>,
}

/// Cause of an early end.
#[derive(Debug, Error)]
pub enum Cause {
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
    /// A study failed.
    #[error("study `{study}` failed: {source}")]
    Study {
        /// Name of the study.
        study: &'static str,
        /// Cause.
        source: StudyError,
    },
    /// A chapter could not be rendered.
    #[error("study `{study}` could not be shown: {source}")]
    Render {
        /// Name of the study.
        study: &'static str,
        /// Cause.
        source: RecordError,
    },
    /// A series could not be converted to a file.
    #[error(transparent)]
    Series(#[from] TableError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

fn kept_in(folder: Option<&Path>) -> String {
    match folder {
        Some(folder) => format!("`{}` holds the studies that ended", folder.display()),
        None => "no study had ended, and no earlier result has changed".to_owned(),
    }
}

/// Runs `studies` and writes records, data, figures and report into the folder of the unfinished run. At the end they replace
/// the files of an earlier run in the folder of `output`.
///
/// # Errors
/// See [`SessionError`]. The completed studies are on disk in any case.
pub fn run(
    lab: &Lab<'_>,
    studies: &[&dyn Study],
    output: &Output,
) -> Result<Results, SessionError> {
    run_as(&command(lab.config), lab, studies, output)
}

/// Does the same for a command of other words, such as those of a file of settings. The report shows it before names of studies.
///
/// # Errors
/// See [`SessionError`].
pub fn run_as(
    command: &str,
    lab: &Lab<'_>,
    studies: &[&dyn Study],
    output: &Output,
) -> Result<Results, SessionError> {
    let results = Results {
        claims_without_study: CLAIMS_WITHOUT_STUDY,
        unjudged: unjudged(lab.config, &[], &[]),
        ..empty(lab, command)
    };
    run_from(results, lab, studies, output)
}

/// The command of a run with the settings of the program.
fn command(config: &Config) -> String {
    match config.effort {
        Effort::Standard => "libration lab".to_owned(),
        effort => format!("libration lab --effort {}", effort.name()),
    }
}

/// Does the same with studies of a system of equations, of which the source report claims nothing.
///
/// # Errors
/// See [`SessionError`].
pub fn run_system(
    lab: &Lab<'_>,
    system: &SystemStudies<'_>,
    studies: &[&dyn Study],
    output: &Output,
) -> Result<Results, SessionError> {
    let results = Results {
        system: Some(system.studied()),
        not_applicable: system.not_applicable.clone(),
        ..empty(lab, &system.command)
    };
    run_from(results, lab, studies, output)
}

/// The results before any study has ended.
fn empty(lab: &Lab<'_>, command: &str) -> Results {
    Results {
        schema: SCHEMA,
        command: command.to_owned(),
        machine: Machine::detect(),
        config: lab.config.clone(),
        system: None,
        seconds: 0.0,
        complete: false,
        claims_without_study: &[],
        unjudged: Vec::new(),
        not_applicable: Vec::new(),
        studies: Vec::new(),
    }
}

fn run_from(
    mut results: Results,
    lab: &Lab<'_>,
    studies: &[&dyn Study],
    output: &Output,
) -> Result<Results, SessionError> {
    match run_all(lab, studies, output, &mut results) {
        Ok(()) => Ok(results),
        Err(cause) => {
            // Without a completed study, the unfinished files belong to an earlier run.
            let kept = if results.studies.is_empty() { None } else { output.keep() };
            Err(SessionError { cause: Box::new(cause), kept })
        }
    }
}

fn run_all(
    lab: &Lab<'_>,
    studies: &[&dyn Study],
    output: &Output,
    results: &mut Results,
) -> Result<(), Cause> {
    let started = Instant::now();
    let mut chapters = Vec::new();
    for &study in studies {
        let begun = Instant::now();
        lab.announce(study.name(), results.studies.len() + 1, studies.len());
        let mut record = match study.run(lab) {
            Ok(record) => record,
            Err(StudyError::Interrupted) => return Err(Cause::Interrupted),
            Err(source) => return Err(Cause::Study { study: study.name(), source }),
        };
        for finding in &mut record.findings {
            finding.command = format!("{} --only {}", results.command, finding.id);
        }
        record.seconds = begun.elapsed().as_secs_f64();
        let mut page = Page::default();
        study
            .render(&record, &mut page)
            .map_err(|source| Cause::Render { study: study.name(), source })?;
        // The commands of the page are those of this system and folder.
        let folder = output.folder().to_string_lossy();
        let folder = shlex::try_quote(&folder).unwrap_or_default();
        for action in &mut page.actions {
            *action = action.replace(FOLDER, &folder);
            if let Some(system) = &results.system {
                *action = action.replace(SYSTEM_OPTION, &system.options);
            }
        }
        if results.studies.is_empty() {
            // The unfinished files of an earlier run stay until the first study is complete.
            output.clear()?;
        }
        record.figures = write_figures(&page, output)?;
        record.data = write_series(&record, output)?;
        chapters.push(Chapter { record: record.clone(), page });
        results.studies.push(record);
        results.seconds = started.elapsed().as_secs_f64();
        let ended = &studies[..results.studies.len()];
        if results.system.is_none() {
            results.unjudged = unjudged(lab.config, ended, &results.studies);
        }
        results.complete = results.studies.len() == studies.len();
        output.write(
            "report.html",
            report::render(&cover(results, &chapters), &chapters).as_bytes(),
        )?;
        // Last, since it names the other files.
        write_results(results, output)?;
    }
    Ok(output.put_in_place()?)
}

/// The folder in the commands of studies.
const FOLDER: &str = "libration-report";

fn write_figures(page: &Page, output: &Output) -> Result<Vec<FigureFile>, OutputError> {
    page.figures()
        .map(|figure| {
            let file = format!("figures/{}.svg", figure.id);
            output.write(&file, figure::svg::standalone(figure).as_bytes())?;
            Ok(FigureFile { id: figure.id.clone(), file })
        })
        .collect()
}

fn write_series(record: &Record, output: &Output) -> Result<Vec<DataFile>, Cause> {
    let write = |series: &Series| {
        let file = format!("data/{}-{}.parquet", record.name, series.name);
        output.write(&file, &series_to_parquet(series)?)?;
        Ok(DataFile { name: series.name.clone(), file })
    };
    record.series.iter().map(write).collect()
}

fn write_results(results: &Results, output: &Output) -> Result<(), OutputError> {
    let json = serde_json::to_vec_pretty(results)
        .map_err(|error| OutputError { path: output.path("results.json"), source: error.into() })?;
    output.write("results.json", &json)
}
