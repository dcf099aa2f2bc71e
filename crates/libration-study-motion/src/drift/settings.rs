//! Settings of the study `drift`.

use libration_settings::validation::{check_list, check_steps};
use libration_settings::{Count, Fault, Number, duration, limits, numbers};
use libration_study::{Settings, schema};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `drift`.
#[derive(Clone, Debug, PartialEq)]
pub struct DriftSettings {
    /// Time steps in s, ascending.
    pub dt: Vec<f64>,
    /// Number of steps.
    pub steps: u64,
}

impl Default for DriftSettings {
    fn default() -> Self {
        DriftSettings { dt: vec![1e-3, 1e-2, 1e-1], steps: 1_000_000 }
    }
}

/// Settings of the study `drift`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Time steps in s, each once.
    #[schemars(schema_with = "schema::time_steps")]
    #[serde(deserialize_with = "duration::list_of_periods")]
    dt: Vec<Number>,
    /// Number of steps at each time step.
    #[schemars(schema_with = "schema::steps")]
    steps: Count,
}

impl Default for Table {
    fn default() -> Self {
        DriftSettings::default().table()
    }
}

impl Settings for DriftSettings {
    const NAME: &'static str = "drift";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { dt: self.dt.iter().copied().map(Number).collect(), steps: Count(self.steps.into()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(DriftSettings {
            dt: numbers(table.dt),
            steps: check_steps("drift.steps", table.steps.0)?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_list("drift.dt", "time step", limits::TIME_STEP, &self.dt)?;
        check_steps("drift.steps", self.steps.into())?;
        Ok(())
    }

    fn sort(&mut self) {
        self.dt.sort_by(f64::total_cmp);
    }
}
