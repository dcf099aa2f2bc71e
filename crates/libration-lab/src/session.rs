//! A run of the laboratory: studies in turn, each written to disk as it ends.

use std::time::Instant;

use serde::Serialize;
use thiserror::Error;

use crate::output::{Output, OutputError};
use crate::page::{Chapter, Page};
use crate::record::RecordError;
use crate::study::StudyError;
use crate::{Config, Lab, Machine, Record, Study};

/// Version of the contract that `results.json` keeps.
pub const SCHEMA: &str = "libration.results/1";

/// Everything that a run found; `results.json` holds just this.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    /// Version of this contract.
    pub schema: &'static str,
    /// Where it was run.
    pub machine: Machine,
    /// What was asked.
    pub config: Config,
    /// Wall-clock time so far, in seconds.
    pub seconds: f64,
    /// Whether all studies that were asked for are in it.
    pub complete: bool,
    /// The records of the studies that have ended.
    pub studies: Vec<Record>,
}

/// Why a run ended early.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The user stopped it; what had ended is on disk.
    #[error("interrupted; finished studies were kept")]
    Interrupted,
    /// A study failed.
    #[error("study `{study}` failed: {source}")]
    Study {
        /// The study.
        study: &'static str,
        /// Why.
        source: StudyError,
    },
    /// A chapter could not be rendered.
    #[error("study `{study}` could not be shown: {source}")]
    Render {
        /// The study.
        study: &'static str,
        /// Why.
        source: RecordError,
    },
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Runs `studies` in turn and writes records, data, figures and report into `output`.
///
/// # Errors
/// See [`SessionError`]. Whatever the error, the studies that had ended by then are on disk.
pub fn run(
    lab: &Lab<'_>,
    studies: &[&dyn Study],
    output: &Output,
) -> Result<Results, SessionError> {
    let started = Instant::now();
    let mut results = Results {
        schema: SCHEMA,
        machine: Machine::detect(),
        config: lab.config.clone(),
        seconds: 0.0,
        complete: false,
        studies: Vec::new(),
    };
    let mut chapters = Vec::new();
    write_results(&results, output)?;
    for &study in studies {
        let begun = Instant::now();
        lab.announce(study.name(), results.studies.len() + 1, studies.len());
        let mut record = match study.run(lab) {
            Ok(record) => record,
            Err(StudyError::Interrupted) => return Err(SessionError::Interrupted),
            Err(source) => return Err(SessionError::Study { study: study.name(), source }),
        };
        record.seconds = begun.elapsed().as_secs_f64();
        let mut page = Page::default();
        study
            .render(&record, &mut page)
            .map_err(|source| SessionError::Render { study: study.name(), source })?;
        chapters.push(Chapter { record: record.clone(), page });
        results.studies.push(record);
        results.seconds = started.elapsed().as_secs_f64();
        results.complete = results.studies.len() == studies.len();
        write_results(&results, output)?;
    }
    Ok(results)
}

fn write_results(results: &Results, output: &Output) -> Result<(), OutputError> {
    let json = serde_json::to_vec_pretty(results)
        .map_err(|error| OutputError { path: output.path("results.json"), source: error.into() })?;
    output.write("results.json", &json)
}
