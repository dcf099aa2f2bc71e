//! Settings of the study `efficiency`.

use libration_settings::validation::{check_counts, check_list, parse_counts};
use libration_settings::{Count, Fault, Number, limits, numbers};
use libration_study::{Settings, schema};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `efficiency`.
#[derive(Clone, Debug, PartialEq)]
pub struct EfficiencySettings {
    /// Tolerated errors in energy and in state, ascending.
    pub tolerances: Vec<f64>,
    /// Horizons in periods of the oscillator, ascending.
    pub periods: Vec<u64>,
}

impl Default for EfficiencySettings {
    fn default() -> Self {
        EfficiencySettings {
            tolerances: vec![1e-6, 1e-4, 1e-2],
            periods: vec![10, 1_000, 1_000_000],
        }
    }
}

/// Settings of the study `efficiency`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Tolerated errors in energy and in state, each once.
    #[schemars(schema_with = "schema::tolerances")]
    tolerances: Vec<Number>,
    /// Horizons in periods of the oscillator, each once.
    #[schemars(schema_with = "schema::horizons")]
    periods: Vec<Count>,
}

impl Default for Table {
    fn default() -> Self {
        EfficiencySettings::default().table()
    }
}

impl Settings for EfficiencySettings {
    const NAME: &'static str = "efficiency";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table {
            tolerances: self.tolerances.iter().copied().map(Number).collect(),
            periods: self.periods.iter().map(|&n| Count(n.into())).collect(),
        }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(EfficiencySettings {
            tolerances: numbers(table.tolerances),
            periods: parse_counts("efficiency.periods", table.periods)?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_list("efficiency.tolerances", "tolerance", limits::TOLERANCE, &self.tolerances)?;
        check_counts("efficiency.periods", &self.periods)?;
        Ok(())
    }

    fn sort(&mut self) {
        self.tolerances.sort_by(f64::total_cmp);
        self.periods.sort_unstable();
    }
}
