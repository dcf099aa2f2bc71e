//! A run of the laboratory: studies in turn, each written to disk as it ends.

use std::time::Instant;

use thiserror::Error;

use crate::export::{ExportError, series_to_parquet};
use crate::output::{Output, OutputError};
use crate::page::{Chapter, Page};
use crate::record::{FigureFile, RecordError};
use crate::results::{Results, SCHEMA};
use crate::study::StudyError;
use crate::tried::unjudged;
use crate::untried::UNTRIED;
use crate::{Lab, Machine, Record, Study, figure, report};

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
    /// A series could not be put into a file.
    #[error(transparent)]
    Export(#[from] ExportError),
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
        untried: UNTRIED,
        unjudged: unjudged(lab.config, &[], &[]),
        studies: Vec::new(),
    };
    let mut chapters = Vec::new();
    // An older report would stand beside newer results.
    output.remove("report.html")?;
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
        record.figures = write_figures(&page, output)?;
        write_series(&record, output)?;
        results.studies.push(record.clone());
        chapters.push(Chapter { record, page });
        results.seconds = started.elapsed().as_secs_f64();
        let ended = &studies[..results.studies.len()];
        results.unjudged = unjudged(lab.config, ended, &results.studies);
        results.complete = results.studies.len() == studies.len();
        write_results(&results, output)?;
        output.write("report.html", report::render(&results, &chapters).as_bytes())?;
    }
    Ok(results)
}

fn write_figures(page: &Page, output: &Output) -> Result<Vec<FigureFile>, OutputError> {
    page.figures()
        .map(|figure| {
            let file = format!("figures/{}.svg", figure.id);
            output.write(&file, figure::svg::standalone(figure).as_bytes())?;
            Ok(FigureFile { id: figure.id.clone(), file })
        })
        .collect()
}

fn write_series(record: &Record, output: &Output) -> Result<(), SessionError> {
    for series in &record.series {
        let file = format!("data/{}-{}.parquet", record.name, series.name);
        output.write(&file, &series_to_parquet(series)?)?;
    }
    Ok(())
}

fn write_results(results: &Results, output: &Output) -> Result<(), OutputError> {
    let json = serde_json::to_vec_pretty(results)
        .map_err(|error| OutputError { path: output.path("results.json"), source: error.into() })?;
    output.write("results.json", &json)
}
