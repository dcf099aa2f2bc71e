//! Settings of the study `adaptive`.

use std::ops::RangeInclusive;

use libration_settings::validation::check_count_in;
use libration_settings::{Count, Fault};
use libration_study::{Settings, schema};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

/// Steps of a period.
const STEPS: RangeInclusive<u64> = 200..=1000;

/// Periods of the long run; fewer show no drift.
const PERIODS: RangeInclusive<u64> = 100..=1_000_000;

/// Eccentricities at which the steps resolve the orbit, and the drift is above rounding.
const ECCENTRICITIES: RangeInclusive<f64> = 0.5..=0.99;

/// Settings of the study `adaptive`.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptiveSettings {
    /// Eccentricities of the orbits, each once.
    pub eccentricities: Vec<f64>,
    /// Steps of a period.
    pub steps: u64,
    /// Periods of the long run.
    pub periods: u64,
}

impl Default for AdaptiveSettings {
    fn default() -> Self {
        AdaptiveSettings { eccentricities: vec![0.9, 0.99], steps: 400, periods: 1000 }
    }
}

/// The study of adaptive steps.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Eccentricities of the orbits, each once.
    eccentricities: Vec<f64>,
    /// Steps of a period.
    #[schemars(schema_with = "steps_schema")]
    steps: Count,
    /// Periods of the long run.
    #[schemars(schema_with = "periods_schema")]
    periods: Count,
}

impl Default for Table {
    fn default() -> Self {
        AdaptiveSettings::default().table()
    }
}

impl Settings for AdaptiveSettings {
    const NAME: &'static str = "adaptive";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table {
            eccentricities: self.eccentricities.clone(),
            steps: Count(self.steps.into()),
            periods: Count(self.periods.into()),
        }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(AdaptiveSettings {
            eccentricities: table.eccentricities,
            steps: check_count_in("adaptive.steps", STEPS, table.steps.0)?,
            periods: check_count_in("adaptive.periods", PERIODS, table.periods.0)?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        let key = "adaptive.eccentricities";
        for (i, e) in self.eccentricities.iter().enumerate() {
            if !ECCENTRICITIES.contains(e) {
                let message = format!("{e} is not 0.5 to 0.99");
                return Err(Fault::at(key, i, message));
            }
            if self.eccentricities[..i].contains(e) {
                return Err(Fault::at(key, i, format!("{e} occurs twice")));
            }
        }
        if self.eccentricities.is_empty() {
            return Err(Fault::new(key, "no eccentricity; expected at least one"));
        }
        check_count_in("adaptive.steps", STEPS, self.steps.into())?;
        check_count_in("adaptive.periods", PERIODS, self.periods.into())?;
        Ok(())
    }
}

fn steps_schema(_: &mut SchemaGenerator) -> Schema {
    schema::count(STEPS)
}

fn periods_schema(_: &mut SchemaGenerator) -> Schema {
    schema::count(PERIODS)
}
