//! Requests for trajectories of linear plants.

use libration::linear::{LinearLoop, LoopTiming};
use libration_settings::limits;

use crate::trajectory::{EnsembleOptions, TrajectoryError, rows};

/// Largest number of values in a table: 8 GB.
const MOST_VALUES: u64 = 1_000_000_000;

/// A loop around a linear plant, its start, and the periods to keep.
#[derive(Clone, Debug)]
pub struct LinearRequest {
    /// The loop.
    pub linear: LinearLoop,
    /// Its timing.
    pub timing: LoopTiming,
    /// The lengths of recorded periods, relative to the period, over and over; none for even ones and those of the jitter.
    pub record: Option<Vec<f64>>,
    /// The initial states.
    pub start: Vec<f64>,
    /// What the controller subtracts from each measurement.
    pub reference: Vec<f64>,
    /// What is added to the command of each input.
    pub disturbance: Vec<f64>,
    /// The number of periods.
    pub steps: u64,
    /// The interval of kept periods. The start and the last one are always kept.
    pub every: u64,
    /// Several loops; none for a single one.
    pub ensemble: Option<EnsembleOptions>,
    /// The seed of all random numbers.
    pub seed: u64,
}

impl LinearRequest {
    /// Names and units of the columns, from left to right.
    pub fn columns(&self) -> Vec<(String, String)> {
        let plant = self.linear.plant();
        let one = |name: &str, unit: &str| (name.to_owned(), unit.to_owned());
        let mut columns = Vec::new();
        columns.extend(self.ensemble.map(|_| one("trajectory", "1")));
        columns.extend([one("step", "1"), one("t", "s")]);
        for (kind, signals) in
            [("", &plant.states), ("measured ", &plant.outputs), ("input ", &plant.inputs)]
        {
            let named = signals.iter().map(|s| (format!("{kind}{}", s.name), s.unit.clone()));
            columns.extend(named);
        }
        columns.push(one("cost", ""));
        columns
    }

    /// Number of rows if the states stay finite.
    pub fn rows(&self) -> u64 {
        rows(self.steps, self.every, self.ensemble.as_ref())
    }

    /// Checks every value.
    pub(super) fn check(&self) -> Result<(), TrajectoryError> {
        let plant = self.linear.plant();
        let value = |name, value: String, allowed: String| {
            Err(TrajectoryError::Value { name, value, allowed })
        };
        for (name, given, count, of) in [
            ("x0", &self.start, plant.states.len(), "states"),
            ("reference", &self.reference, plant.outputs.len(), "outputs"),
            ("disturbance", &self.disturbance, plant.inputs.len(), "inputs"),
        ] {
            if given.len() != count {
                let allowed = format!("{count} numbers, one for each of the {of}");
                return value(name, format!("{} numbers", given.len()), allowed);
            }
            if let Some(x) = given.iter().find(|x| !x.is_finite()) {
                return value(name, format!("{x:?}"), "finite".to_owned());
            }
        }
        if !limits::TRAJECTORY_STEPS.contains(&self.steps) {
            return value("steps", self.steps.to_string(), limits::trajectory_steps_allowed());
        }
        if self.every == 0 {
            return value("every", "0".to_owned(), "at least 1".to_owned());
        }
        let values = self.rows().saturating_mul(self.columns().len() as u64);
        if values > MOST_VALUES {
            let allowed =
                format!("such that rows × columns is at most {MOST_VALUES}; it is {values}");
            return value("every", self.every.to_string(), allowed);
        }
        Ok(())
    }
}
