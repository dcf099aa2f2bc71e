//! Settings of the study `error`.

use libration_settings::validation::{check_number, check_steps};
use libration_settings::{Count, Fault, Number, duration, limits};
use libration_study::{Settings, schema};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `error`.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorSettings {
    /// Time step in s.
    pub dt: f64,
    /// Number of steps.
    pub steps: u64,
}

impl Default for ErrorSettings {
    fn default() -> Self {
        ErrorSettings { dt: 1e-3, steps: 1_000_000 }
    }
}

/// Settings of the study `error`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Time step in s.
    #[schemars(schema_with = "schema::time_step")]
    #[serde(deserialize_with = "duration::number_of_period")]
    dt: Number,
    /// Number of steps.
    #[schemars(schema_with = "schema::steps")]
    steps: Count,
}

impl Default for Table {
    fn default() -> Self {
        ErrorSettings::default().table()
    }
}

impl Settings for ErrorSettings {
    const NAME: &'static str = "error";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { dt: Number(self.dt), steps: Count(self.steps.into()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(ErrorSettings { dt: table.dt.0, steps: check_steps("error.steps", table.steps.0)? })
    }

    fn check(&self) -> Result<(), Fault> {
        check_number("error.dt", limits::TIME_STEP, self.dt)?;
        check_steps("error.steps", self.steps.into())?;
        Ok(())
    }
}
