//! The interface of a study.

use std::error;

use libration::simulation::SimulationError;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_work::Interrupted;
use thiserror::Error;

use crate::Lab;
use crate::settings::Section;
use crate::source_claim::SourceClaim;

/// A study: a question, a run, and the chapter of a report.
pub trait Study: Sync {
    /// Returns the name on the command line, as `drift`.
    fn name(&self) -> &'static str;

    /// Returns the question of the study.
    fn question(&self) -> &'static str;

    /// Returns whether it measures the machine that it runs on: such a study runs only if it is named.
    fn measures_the_machine(&self) -> bool {
        false
    }

    /// Returns the claims of the source report that the study judges.
    fn source_claims(&self) -> &'static [SourceClaim] {
        &[]
    }

    /// Returns the table of the study in the configuration, if any: `Some(Section::of::<S>())` with its [`Settings`](crate::Settings) `S`.
    fn settings(&self) -> Option<Section> {
        None
    }

    /// Runs the study and returns its record.
    ///
    /// # Errors
    /// If the run is interrupted, or impossible with this configuration.
    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError>;

    /// Renders the chapter from a record.
    ///
    /// # Errors
    /// If the record lacks data of the chapter.
    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError>;
}

/// Error of a study.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The user stopped the run.
    #[error("interrupted")]
    Interrupted,
    /// A simulation failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The record has no such entry.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A system could not be built.
    #[error(transparent)]
    System(#[from] libration::CatalogError),
    /// An ensemble could not be created or run.
    #[error(transparent)]
    Ensemble(#[from] libration::ensemble::EnsembleError),
    /// The cost of a loop could not be computed.
    #[error(transparent)]
    Cost(#[from] libration::analysis::CostError),
    /// Environments could not be created or run.
    #[error(transparent)]
    Environment(#[from] libration::rl::EnvironmentError),
    /// A replay buffer could not be created or used.
    #[error(transparent)]
    Replay(#[from] libration::replay::ReplayError),
    /// Another error.
    #[error(transparent)]
    Other(Box<dyn error::Error + Send + Sync>),
    /// Exact arithmetic ran out of digits.
    #[error("exact arithmetic overflowed while {0}")]
    Exact(String),
}

impl From<Interrupted> for StudyError {
    fn from(_: Interrupted) -> Self {
        StudyError::Interrupted
    }
}
