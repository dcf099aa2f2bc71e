//! What can be wrong with a request, and what can go wrong with a trajectory.

use libration::CatalogError;
use libration::ensemble::{EnsembleError, InsufficientMemory};
use libration::simulation::SimulationError;
use thiserror::Error;

use crate::export::ExportError;

/// Why there is no trajectory.
#[derive(Debug, Error)]
pub enum TrajectoryError {
    /// A value of the request is not allowed.
    #[error("`{name}` is {value}, but it must be {allowed}")]
    Value {
        /// The field of the request, which is also the name of its flag.
        name: &'static str,
        /// The value that was given.
        value: String,
        /// The values that it may have.
        allowed: String,
    },
    /// A parameter of the system has no counterpart in the float type.
    #[error("{system}: `{name}` = {value:?} is {rounded} in {float}; choose a wider float type")]
    Parameter {
        /// The system.
        system: &'static str,
        /// The parameter.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// What the float type makes of it.
        rounded: f64,
        /// The float type.
        float: &'static str,
    },
    /// The system does not exist in that dimension.
    #[error(transparent)]
    Catalog(#[from] CatalogError),
    /// The simulator refused to start.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The ensemble could not be made.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// There is not memory enough.
    #[error("{0} (--count, --every, --float)")]
    Memory(InsufficientMemory),
    /// The result could not be written or kept.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The caller stopped it.
    #[error("interrupted")]
    Interrupted,
}

impl TrajectoryError {
    /// The memory that is missing, if it is that.
    pub fn room(&self) -> Option<&InsufficientMemory> {
        match self {
            TrajectoryError::Memory(room)
            | TrajectoryError::Ensemble(EnsembleError::Memory(room)) => Some(room),
            _ => None,
        }
    }
}
