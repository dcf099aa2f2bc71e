//! Settings of the study `precision`.

use libration_settings::validation::{check_list, check_steps};
use libration_settings::{Count, Fault, Number, duration, limits, numbers};
use libration_study::{Settings, schema};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `precision`.
#[derive(Clone, Debug, PartialEq)]
pub struct PrecisionSettings {
    /// Time steps in s, ascending.
    pub dt: Vec<f64>,
    /// Number of steps.
    pub steps: u64,
}

impl Default for PrecisionSettings {
    fn default() -> Self {
        PrecisionSettings { dt: vec![1e-3, 1e-2], steps: 1_000_000 }
    }
}

/// Settings of the study `precision`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Time steps in s, each once.
    #[schemars(schema_with = "schema::time_steps")]
    #[serde(deserialize_with = "duration::list_of_periods")]
    dt: Vec<Number>,
    /// Number of steps.
    #[schemars(schema_with = "schema::steps")]
    steps: Count,
}

impl Default for Table {
    fn default() -> Self {
        PrecisionSettings::default().table()
    }
}

impl Settings for PrecisionSettings {
    const NAME: &'static str = "precision";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { dt: self.dt.iter().copied().map(Number).collect(), steps: Count(self.steps.into()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(PrecisionSettings {
            dt: numbers(table.dt),
            steps: check_steps("precision.steps", table.steps.0)?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_list("precision.dt", "time step", limits::TIME_STEP, &self.dt)?;
        check_steps("precision.steps", self.steps.into())?;
        Ok(())
    }

    fn sort(&mut self) {
        self.dt.sort_by(f64::total_cmp);
    }
}
