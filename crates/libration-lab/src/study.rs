//! A study is a question.

use libration::simulation::SimulationError;
use libration_data::DataError;
use thiserror::Error;

use crate::dataset::DatasetError;
use crate::page::Page;
use crate::record::RecordError;
use crate::tried::{self, Tried};
use crate::{Lab, Record};

/// A question, the way to its answer, and the chapter that gives it.
pub trait Study: Sync {
    /// Name on the command line, as in `drift`.
    fn name(&self) -> &'static str;

    /// The question that the study answers.
    fn question(&self) -> &'static str;

    /// The claims of the source report that it tries.
    fn tries(&self) -> Vec<&'static Tried> {
        tried::by(self.name())
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
    /// A data set could not be written.
    #[error(transparent)]
    Dataset(Box<DatasetError>),
    /// Exact arithmetic ran out of digits.
    #[error("exact arithmetic overflowed while {0}")]
    Exact(String),
}

impl From<DatasetError> for StudyError {
    fn from(error: DatasetError) -> Self {
        match error {
            DatasetError::Interrupted => StudyError::Interrupted,
            error => StudyError::Dataset(Box::new(error)),
        }
    }
}

impl From<DataError> for StudyError {
    fn from(error: DataError) -> Self {
        DatasetError::from(error).into()
    }
}
