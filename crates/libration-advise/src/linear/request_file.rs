//! Request files for loops around linear plants.

use std::collections::BTreeMap;

use libration_settings::Number;
use libration_settings::linear_loop::{
    LinearControllerTable, LinearLoopTable, PartTable, PlantTable,
};
use serde::Deserialize;

/// A request file for a loop around a linear plant.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct RequestFile {
    /// The plant.
    pub system: SystemTable,
    /// Lags and filters.
    pub part: Vec<PartTable>,
    /// The controller.
    pub controller: Option<LinearControllerTable>,
    /// The loop and its timing.
    #[serde(rename = "loop")]
    pub looped: LinearLoopTable,
    /// A tolerance of the cost.
    pub tolerance: BTreeMap<String, Number>,
}

/// The table `[system]` of a request file.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SystemTable {
    /// The plant.
    #[serde(default)]
    pub linear: PlantTable,
}

/// The period in s of a loop that states none, around a plant in continuous time.
const PERIOD: f64 = 0.01;

impl RequestFile {
    /// The sampling period in s: that of the loop, of a sampled plant, or 0.01.
    pub fn period(&self) -> f64 {
        let of_plant = self.system.linear.sampling_period;
        self.looped.period.or(of_plant).map_or(PERIOD, |Number(period)| period)
    }
}
