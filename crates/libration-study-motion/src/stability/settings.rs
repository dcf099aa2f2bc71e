//! Settings of the study `stability`.

use libration_settings::validation::{check_counts, check_list, parse_counts};
use libration_settings::{Count, Fault, Number, limits, numbers};
use libration_study::{Settings, schema};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `stability`.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilitySettings {
    /// Tolerated relative energy drifts, ascending.
    pub tolerances: Vec<f64>,
    /// Numbers of steps, ascending.
    pub steps: Vec<u64>,
}

impl Default for StabilitySettings {
    fn default() -> Self {
        StabilitySettings {
            tolerances: vec![1e-3, 1e-2, 1e-1],
            steps: vec![1_000, 10_000, 100_000],
        }
    }
}

/// Settings of the study `stability`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Tolerated relative energy drifts, each once.
    #[schemars(schema_with = "schema::tolerances")]
    tolerances: Vec<Number>,
    /// Numbers of steps, each once.
    #[schemars(schema_with = "schema::horizons")]
    steps: Vec<Count>,
}

impl Default for Table {
    fn default() -> Self {
        StabilitySettings::default().table()
    }
}

impl Settings for StabilitySettings {
    const NAME: &'static str = "stability";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table {
            tolerances: self.tolerances.iter().copied().map(Number).collect(),
            steps: self.steps.iter().map(|&n| Count(n.into())).collect(),
        }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(StabilitySettings {
            tolerances: numbers(table.tolerances),
            steps: parse_counts("stability.steps", table.steps)?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_list("stability.tolerances", "tolerance", limits::TOLERANCE, &self.tolerances)?;
        check_counts("stability.steps", &self.steps)?;
        Ok(())
    }

    fn sort(&mut self) {
        self.tolerances.sort_by(f64::total_cmp);
        self.steps.sort_unstable();
    }
}
