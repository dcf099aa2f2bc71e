//! A system and where it starts.

use libration::catalog::{Actuation, Entry};
use libration::{AnySystem, CatalogError, State, with_system};
use thiserror::Error;

/// A system that can be simulated: `q` and `v` are as long as one of its dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The system with its parameters.
    pub system: AnySystem,
    /// The quantity of its commands.
    pub actuation: Actuation,
    /// Positions at the start.
    pub q: Vec<f64>,
    /// Velocities at the start.
    pub v: Vec<f64>,
}

/// Why a system cannot start there.
#[derive(Debug, Error)]
pub enum SettingError {
    /// It does not exist in as many dimensions as there are coordinates.
    #[error(transparent)]
    Dimension(#[from] CatalogError),
    /// Time does not pass at another rate.
    #[error("--v ends in {rate}, but the second coordinate of {system} is time, so it must be 1")]
    Rate {
        /// The velocity of that coordinate.
        rate: f64,
        /// The system.
        system: &'static str,
    },
}

impl Setting {
    /// The system and its start; what is not given comes from the catalogue.
    ///
    /// # Errors
    /// [`SettingError`]. That positions and velocities are equally many is for those to check who say what both are called.
    pub fn new(
        (system, actuation): (AnySystem, Actuation),
        q: Option<Vec<f64>>,
        v: Option<Vec<f64>>,
    ) -> Result<Self, SettingError> {
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
                Err(SettingError::Rate { rate, system: entry.name })
            }
            _ => Ok(Setting { system, actuation, q, v }),
        }
    }
}

fn default_start<const D: usize>(entry: &Entry) -> (Vec<f64>, Vec<f64>) {
    let start: Option<State<f64, D>> = entry.start();
    start.map(|State { q, v }| (q.to_vec(), v.to_vec())).unwrap_or_default()
}
