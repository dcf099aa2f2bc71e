//! Settings of the study `convergence`.

use libration_settings::{Count, Fault};
use libration_study::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::subject::settings::{check_systems, coarsest, coarsest_schema, systems_schema};

/// Settings of the study `convergence`.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergenceSettings {
    /// Systems, each once, from [`SYSTEMS`](crate::SYSTEMS).
    pub systems: Vec<String>,
    /// Steps per turn at the largest time step, a multiple of 16.
    pub coarsest: u64,
}

impl Default for ConvergenceSettings {
    fn default() -> Self {
        ConvergenceSettings {
            systems: ["oscillator", "pendulum", "henon-heiles", "kepler"]
                .map(String::from)
                .to_vec(),
            coarsest: 64,
        }
    }
}

/// Settings of the study `convergence`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Systems, each once.
    #[schemars(schema_with = "systems_schema")]
    systems: Vec<String>,
    /// Steps per turn at the largest time step, a multiple of 16.
    #[schemars(schema_with = "coarsest_schema")]
    coarsest: Count,
}

impl Default for Table {
    fn default() -> Self {
        ConvergenceSettings::default().table()
    }
}

impl Settings for ConvergenceSettings {
    const NAME: &'static str = "convergence";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { systems: self.systems.clone(), coarsest: Count(self.coarsest.into()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(ConvergenceSettings {
            systems: table.systems,
            coarsest: coarsest("convergence.coarsest", table.coarsest.0)?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_systems("convergence.systems", &self.systems)?;
        coarsest("convergence.coarsest", self.coarsest.into())?;
        Ok(())
    }
}
