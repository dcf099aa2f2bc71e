//! A study is a question.

use std::error;

use libration::simulation::SimulationError;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_work::Interrupted;
use thiserror::Error;

use crate::Lab;
use crate::settings::Section;
use crate::tried::Tried;

/// A question, the way to its answer, and the chapter that gives it.
pub trait Study: Sync {
    /// Name on the command line, as in `drift`.
    fn name(&self) -> &'static str;

    /// The question that the study answers.
    fn question(&self) -> &'static str;

    /// The claims of the source report that it tries.
    fn tries(&self) -> &'static [Tried] {
        &[]
    }

    /// Its table in the configuration, if it has one: `Some(Section::of::<S>())` with its [`Settings`](crate::Settings) `S`.
    fn settings(&self) -> Option<Section> {
        None
    }

    /// Does the work; leaves numbers only.
    ///
    /// # Errors
    /// If the work is interrupted, or cannot be done under this configuration.
    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError>;

    /// Writes the chapter that the record supports.
    ///
    /// # Errors
    /// If the record lacks something that the chapter shows.
    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError>;
}

/// Why a study gave no record.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The user asked for the run to stop.
    #[error("interrupted")]
    Interrupted,
    /// A simulation could not be run.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The study misused its own record.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A system could not be built.
    #[error(transparent)]
    System(#[from] libration::CatalogError),
    /// Trajectories could not be made or run together.
    #[error(transparent)]
    Ensemble(#[from] libration::ensemble::EnsembleError),
    /// The cost of a loop could not be found.
    #[error(transparent)]
    Cost(#[from] libration::analysis::CostError),
    /// Environments could not be made or run.
    #[error(transparent)]
    Environment(#[from] libration::rl::EnvironmentError),
    /// A replay buffer could not be made or used.
    #[error(transparent)]
    Replay(#[from] libration::replay::ReplayError),
    /// The work failed in a way of its own.
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
