//! Initial value problems.

use libration::catalog::{Actuation, Entry};
use libration::{AnySystem, CatalogError, State, with_system};
use thiserror::Error;

/// A system with its initial state. `q` and `v` have the same, allowed dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialValueProblem {
    /// The system with its parameters.
    pub system: AnySystem,
    /// The quantity of its commands.
    pub actuation: Actuation,
    /// Initial positions.
    pub q: Vec<f64>,
    /// Initial velocities.
    pub v: Vec<f64>,
}

/// Error of an initial value problem.
#[derive(Debug, Error)]
pub enum InitialValueError {
    /// The system does not exist in this dimension.
    #[error(transparent)]
    Dimension(#[from] CatalogError),
    /// The rate of a time coordinate is not 1.
    #[error(
        "--v ends in {rate}, but the second coordinate of {system} is time, so its rate must be 1"
    )]
    Rate {
        /// The velocity of that coordinate.
        rate: f64,
        /// The system.
        system: &'static str,
    },
}

impl InitialValueProblem {
    /// The problem of `system`; the catalogue supplies missing coordinates.
    ///
    /// # Errors
    /// [`InitialValueError`]. The caller checks that `q` and `v` have the same length.
    pub fn new(
        (system, actuation): (AnySystem, Actuation),
        q: Option<Vec<f64>>,
        v: Option<Vec<f64>>,
    ) -> Result<Self, InitialValueError> {
        let entry = system.entry();
        let given = q.as_ref().or(v.as_ref());
        let dimension = given.map_or(*entry.dimensions.start(), Vec::len);
        let start = with_system!(
            system,
            dimension,
            |_model, D| default_start::<D>(entry),
            return Err(entry.wrong_dimension(dimension).into())
        );
        let (q, v) = (q.unwrap_or(start.0), v.unwrap_or(start.1));
        match (system, v.as_slice()) {
            (AnySystem::DrivenOscillator(_), &[_, rate]) if rate != 1.0 => {
                Err(InitialValueError::Rate { rate, system: entry.name })
            }
            _ => Ok(InitialValueProblem { system, actuation, q, v }),
        }
    }
}

fn default_start<const D: usize>(entry: &Entry) -> (Vec<f64>, Vec<f64>) {
    let start: Option<State<f64, D>> = entry.start();
    start.map(|State { q, v }| (q.to_vec(), v.to_vec())).unwrap_or_default()
}
