//! Errors of trajectories.

use libration::CatalogError;
use libration::control::Latency;
use libration::ensemble::{EnsembleError, InsufficientMemory};
use libration::linear_loops::LinearLoopsError;
use libration::simulation::SimulationError;
use thiserror::Error;

use crate::export::ExportError;

/// Error of a trajectory.
#[derive(Debug, Error)]
pub enum TrajectoryError {
    /// A value of the request is invalid.
    #[error("`{name}` is {value}, but it must be {allowed}")]
    Value {
        /// The field of the request.
        name: &'static str,
        /// The given value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// The float type cannot represent a parameter of the system.
    #[error("{system}: `{name}` = {value:?} is {rounded} in {float}; choose a wider float type")]
    Parameter {
        /// The system.
        system: String,
        /// The parameter.
        name: String,
        /// The given value.
        value: f64,
        /// The value rounded to the float type.
        rounded: f64,
        /// The float type.
        float: &'static str,
    },
    /// The system does not exist in this dimension.
    #[error(transparent)]
    Catalog(#[from] CatalogError),
    /// The bodies or their integrator are invalid.
    #[error("{0}")]
    Bodies(String),
    /// The simulator rejected the request.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The ensemble could not be created.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// The loops around a linear plant could not be created.
    #[error(transparent)]
    LinearLoops(#[from] LinearLoopsError),
    /// There is not enough memory.
    #[error("{0} (--num-trajectories, --save-every, --dtype)")]
    Memory(InsufficientMemory),
    /// The result could not be written or kept.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The latency is far too long for the step, in words.
    #[error("--latency: {0}")]
    ExcessiveLatency(String),
    /// The caller stopped the simulation.
    #[error("interrupted")]
    Interrupted,
}

impl TrajectoryError {
    /// The error of a latency of `steps` steps of `dt` seconds.
    pub(super) fn latency(steps: f64, dt: f64) -> Self {
        TrajectoryError::Value {
            name: "latency",
            value: format!("{steps:?} steps of {dt:?} s"),
            allowed: format!("at least 0 and at most {} steps", Latency::MOST_STEPS),
        }
    }

    /// The missing memory, if that is the error.
    pub fn missing_memory(&self) -> Option<&InsufficientMemory> {
        match self {
            TrajectoryError::Memory(room)
            | TrajectoryError::LinearLoops(LinearLoopsError::Memory(room))
            | TrajectoryError::Ensemble(EnsembleError::Memory(room)) => Some(room),
            _ => None,
        }
    }
}

pub(super) fn value_error(
    name: &'static str,
    value: impl ToString,
    allowed: impl ToString,
) -> TrajectoryError {
    TrajectoryError::Value { name, value: value.to_string(), allowed: allowed.to_string() }
}
