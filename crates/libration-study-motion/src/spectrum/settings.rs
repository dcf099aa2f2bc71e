//! Settings of the study `spectrum`.

use libration_settings::validation::check_number;
use libration_settings::{Fault, Number, duration, limits};
use libration_study::{Settings, schema};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `spectrum`.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectrumSettings {
    /// Time step of the tables in s.
    pub dt: f64,
}

impl Default for SpectrumSettings {
    fn default() -> Self {
        SpectrumSettings { dt: 0.01 }
    }
}

/// Settings of the study `spectrum`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Time step of the tables in s.
    #[schemars(schema_with = "schema::time_step")]
    #[serde(deserialize_with = "duration::number_of_period")]
    dt: Number,
}

impl Default for Table {
    fn default() -> Self {
        SpectrumSettings::default().table()
    }
}

impl Settings for SpectrumSettings {
    const NAME: &'static str = "spectrum";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { dt: Number(self.dt) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(SpectrumSettings { dt: table.dt.0 })
    }

    fn check(&self) -> Result<(), Fault> {
        check_number("spectrum.dt", limits::TIME_STEP, self.dt)?;
        Ok(())
    }
}
