//! Settings of the study `nonlinear`.

use std::ops::RangeInclusive;

use libration_settings::validation::check_count_in;
use libration_settings::{Count, Fault};
use libration_study::{Settings, schema};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use crate::subject::settings::{check_systems, systems_schema};

/// Steps per turn over a long horizon.
const STEPS_A_TURN: RangeInclusive<u64> = 16..=10_000;

/// Turns of a long horizon; fewer turns show no growth.
const TURNS: RangeInclusive<u64> = 100..=100_000;

/// Settings of the study `nonlinear`.
#[derive(Clone, Debug, PartialEq)]
pub struct NonlinearSettings {
    /// Systems, each once, from [`SYSTEMS`](crate::SYSTEMS).
    pub systems: Vec<String>,
    /// Steps per turn over the long horizon.
    pub steps: u64,
    /// Turns of the long horizon.
    pub turns: u64,
}

impl Default for NonlinearSettings {
    fn default() -> Self {
        NonlinearSettings {
            systems: ["pendulum", "henon-heiles", "kepler"].map(String::from).to_vec(),
            steps: 200,
            turns: 1000,
        }
    }
}

/// The study of nonlinear systems.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Systems, each once.
    #[schemars(schema_with = "systems_schema")]
    systems: Vec<String>,
    /// Steps per turn over the long horizon.
    #[schemars(schema_with = "steps_schema")]
    steps: Count,
    /// Turns of the long horizon.
    #[schemars(schema_with = "turns_schema")]
    turns: Count,
}

impl Default for Table {
    fn default() -> Self {
        NonlinearSettings::default().table()
    }
}

impl Settings for NonlinearSettings {
    const NAME: &'static str = "nonlinear";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table {
            systems: self.systems.clone(),
            steps: Count(self.steps.into()),
            turns: Count(self.turns.into()),
        }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(NonlinearSettings {
            systems: table.systems,
            steps: check_count_in("nonlinear.steps", STEPS_A_TURN, table.steps.0)?,
            turns: check_count_in("nonlinear.turns", TURNS, table.turns.0)?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_systems("nonlinear.systems", &self.systems)?;
        check_count_in("nonlinear.steps", STEPS_A_TURN, self.steps.into())?;
        check_count_in("nonlinear.turns", TURNS, self.turns.into())?;
        Ok(())
    }
}

fn steps_schema(_: &mut SchemaGenerator) -> Schema {
    schema::count(STEPS_A_TURN)
}

fn turns_schema(_: &mut SchemaGenerator) -> Schema {
    schema::count(TURNS)
}
