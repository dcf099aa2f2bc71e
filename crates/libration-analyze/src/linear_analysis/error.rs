//! Errors of an analysis of a linear plant.

use libration::linear::LinearLoopError;
use libration_work::Interrupted;
use thiserror::Error;

/// Error of an analysis of a linear plant.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LinearAnalysisError {
    /// The time step is invalid.
    #[error("`dt` is {0:?} s; expected a finite number above 0")]
    Dt(f64),
    /// The integrator requires positions and velocities.
    #[error(
        "--integrator {name} requires positions and velocities, but half of the states of the plant are not the rates of the other half; expected {}",
        .allowed.join(", ")
    )]
    Integrator {
        /// The integrator.
        name: &'static str,
        /// Those that apply.
        allowed: Vec<&'static str>,
    },
    /// An integrator for a plant that is sampled.
    #[error(
        "--{option} is given, but the plant is sampled every {period} s; expected a plant in continuous time"
    )]
    Sampled {
        /// The option.
        option: &'static str,
        /// The sampling period.
        period: f64,
    },
    /// The eigenvalues of the plant are not known.
    #[error("the eigenvalues of the plant are beyond the range of floats")]
    Eigenvalues,
    /// The timing of the loop is invalid.
    #[error(transparent)]
    Loop(#[from] LinearLoopError),
    /// The caller stopped the analysis.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for LinearAnalysisError {
    fn from(_: Interrupted) -> Self {
        LinearAnalysisError::Interrupted
    }
}
