//! The systems that plants are linearisations of.

use std::path::Path;

use libration::catalog;

use super::subject::{Subject, is_file};
use super::{PlantTable, plant_file};
use crate::Fault;
use crate::equations::EquationSystem;

impl PlantTable {
    /// The system of equations that the plant is the linearisation of; none of other plants.
    ///
    /// # Errors
    /// [`Fault`]: as for [`PlantTable::plant`].
    pub fn equations(&self) -> Result<Option<EquationSystem>, Fault> {
        match (&self.file, &self.of) {
            (Some(file), _) => {
                let table = plant_file::read(Path::new(file));
                table.map_err(|why| Fault::new("system.linear.file", why))?.equations()
            }
            (None, Some(of)) if is_file(of) => {
                let parameters = self.parameters.iter().map(|(name, x)| (name.clone(), x.0));
                Subject::system_of_file(of, &parameters.collect::<Vec<_>>()).map(Some)
            }
            (None, _) => Ok(None),
        }
    }

    /// Whether the plant is a linear system of the catalogue.
    pub fn is_linear_system(&self) -> bool {
        let parameters = self.parameters.iter().map(|(name, x)| (name.as_str(), x.0));
        let system = self.of.as_ref().map(|of| catalog::build(of, &parameters.collect::<Vec<_>>()));
        system.is_some_and(|system| system.is_ok_and(|(system, _)| system.is_linear()))
    }
}
