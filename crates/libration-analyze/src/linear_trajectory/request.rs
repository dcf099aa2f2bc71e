//! Requests for trajectories of linear plants.

use libration::linear::{LinearLoop, LoopTiming, Matrix};
use libration::linear_loops::ProgramMotion;
use libration_settings::limits;

use crate::trajectory::{EnsembleOptions, TrajectoryError, rows};

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
    /// The motion of the system of which the plant is the linearisation; none for that of the plant.
    pub motion: Option<ProgramMotion>,
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

    /// States, outputs and inputs at the operating point of a [motion](LinearRequest::motion); zero without one.
    pub(super) fn operating_point(&self) -> [Vec<f64>; 3] {
        let plant = self.linear.plant();
        let Some(motion) = &self.motion else {
            return [&plant.states, &plant.outputs, &plant.inputs].map(|all| vec![0.0; all.len()]);
        };
        let ProgramMotion { operating_point, places, .. } = motion;
        let states: Vec<f64> = places.iter().map(|&place| operating_point[place]).collect();
        let inputs = operating_point[operating_point.len() - plant.inputs.len()..].to_vec();
        let product = |matrix: &Matrix, i: usize, x: &[f64]| -> f64 {
            matrix.row(i).iter().zip(x).map(|(a, x)| a * x).sum()
        };
        let output = |j| product(&plant.c, j, &states) + product(&plant.d, j, &inputs);
        [states.clone(), (0..plant.outputs.len()).map(output).collect(), inputs]
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
        if let Some(ProgramMotion { longest_step, .. }) = self.motion {
            let least = 1e-6 * self.linear.period();
            if longest_step < least || longest_step.is_nan() {
                let allowed = format!("at least a millionth of the period, {least:e} s");
                return value("dt", format!("{longest_step:e}"), allowed);
            }
        }
        if self.every == 0 {
            return value("every", "0".to_owned(), "at least 1".to_owned());
        }
        Ok(())
    }
}
