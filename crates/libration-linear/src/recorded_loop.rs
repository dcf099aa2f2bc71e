//! Loops around linear plants whose periods repeat a record.

use crate::loop_timing::MOST_RANDOM;
use crate::{LinearLoop, LinearLoopError, LoopTiming, RecordedSchedule};

/// Most states of a loop that replays a record with losses.
const MOST_RECORDED: usize = 24;

impl LinearLoop {
    /// The mean growth rate of second moments per period where the lengths of periods, relative to their mean, repeat `record`. The
    /// jitter of the timing is ignored.
    ///
    /// # Errors
    /// As for [`LinearLoop::growth`], and [`LinearLoopError::Record`].
    pub fn recorded_growth(
        &self,
        timing: &LoopTiming,
        record: &[f64],
    ) -> Result<f64, LinearLoopError> {
        Ok(self.recorded(timing, record, false)?.growth())
    }

    /// The stationary cost of that loop; infinite where second moments grow.
    ///
    /// # Errors
    /// As for [`LinearLoop::recorded_growth`].
    pub fn recorded_cost(
        &self,
        timing: &LoopTiming,
        record: &[f64],
    ) -> Result<f64, LinearLoopError> {
        Ok(self.recorded(timing, record, true)?.cost())
    }

    fn recorded(
        &self,
        timing: &LoopTiming,
        record: &[f64],
        with_cost: bool,
    ) -> Result<RecordedSchedule, LinearLoopError> {
        let wrong = record.iter().find(|length| !(**length >= 0.0 && length.is_finite()));
        let none = if record.iter().any(|length| *length > 0.0) { None } else { Some(&0.0) };
        if let Some(&length) = wrong.or(none) {
            return Err(LinearLoopError::Record(length));
        }
        let even = LoopTiming { jitter: timing.jitter.with_rms(0.0), ..timing.clone() };
        let size = self.size(&even)?;
        let most = if timing.loss > 0.0 { MOST_RECORDED } else { MOST_RANDOM };
        if size > most {
            return Err(LinearLoopError::Size { size, most });
        }
        let controllers = self.controllers();
        // Checked once, for all lengths.
        self.stages_of(0, &even, (&[(1.0, 0.0)], true), with_cost)?;
        let draws = timing.loss > 0.0;
        let stages = |length: f64, kind: usize| {
            let nodes = [(1.0, length - 1.0)];
            self.stages_of(kind, &even, (&nodes, true), with_cost).unwrap_or_default()
        };
        Ok(RecordedSchedule::with_controllers(record, controllers.order(), draws, stages))
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::Latency;

    use super::*;
    use crate::{Cascade, ClockedController, DiscreteController, LinearPlant, Matrix, Simulation};

    /// A motor whose speed follows the reference of its angle, computed every fourth period.
    fn motor() -> LinearLoop {
        let a = Matrix::from_rows(&[[0.0, 1.0], [0.0, -2.0]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [2.0]]).unwrap();
        let plant = LinearPlant::new(a, b, Matrix::identity(2), Matrix::zeros(2, 1)).unwrap();
        let gain = |row: &[f64]| DiscreteController::gain(Matrix::from_rows(&[row]).unwrap());
        let cascade = Cascade {
            inner: gain(&[0.0, -2.0, 2.0]),
            outer: gain(&[-1.0, 0.0]),
            inner_every: 1,
            outer_every: 4,
            outer_latency: 1,
        };
        let schedule = cascade.schedule().unwrap();
        LinearLoop::new(plant, schedule, 0.1, Matrix::identity(3), vec![1e-3; 2]).unwrap()
    }

    #[test]
    fn a_record_of_equal_periods_is_an_even_clock_also_for_a_cascade_and_with_losses() {
        let linear = motor();
        for loss in [0.0, 0.2] {
            let timing = LoopTiming {
                loss,
                input_latency: vec![Latency::of_steps(0.4).unwrap()],
                ..linear.ideal()
            };
            for count in [1, 2, 3, 6] {
                let record = vec![1.0; count];
                let growth = linear.recorded_growth(&timing, &record).unwrap();
                let wanted = linear.growth(&timing).unwrap();
                assert!((growth / wanted - 1.0).abs() < 1e-9, "{count}: {growth} {wanted}");
                let cost = linear.recorded_cost(&timing, &record).unwrap();
                let wanted = linear.stationary(&timing).unwrap().unwrap().cost;
                assert!((cost / wanted - 1.0).abs() < 1e-9, "{count}: {cost} {wanted}");
            }
        }
    }

    #[test]
    fn loops_with_a_record_cost_what_is_predicted_also_for_a_cascade_and_a_measured_clock() {
        let cascade = motor();
        // The angle over the seconds that have passed, as a rate.
        let of_length = |seconds: f64| DiscreteController {
            a: Matrix::zeros(1, 1),
            b: Matrix::from_rows(&[[1.0, 0.0]]).unwrap(),
            c: Matrix::diagonal(&[0.5 / seconds]),
            d: Matrix::from_rows(&[[-2.0 - 0.5 / seconds, 0.0]]).unwrap(),
        };
        let clocked = ClockedController::new(0.1, of_length);
        let measured = cascade.with_measured_clock(clocked).unwrap();
        // Six periods and a cascade of four, which meet after twelve, in a place of their own.
        let record = [0.5, 1.4, 0.7, 1.5, 0.8, 1.1];
        for linear in [cascade, measured] {
            let timing = LoopTiming {
                input_latency: vec![Latency::of_steps(0.4).unwrap()],
                ..linear.ideal()
            };
            let predicted = linear.with_held_noise().recorded_cost(&timing, &record).unwrap();
            let one =
                Simulation { linear: &linear, timing: &timing, record: Some(&record), seed: 5 };
            let costs: Vec<f64> = (0..48).map(|k| one.mean_cost(k, 240, 2400)).collect();
            let mean = costs.iter().sum::<f64>() / 48.0;
            let variance = costs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 47.0;
            let z = (mean - predicted) / (variance / 48.0).sqrt();
            // Student's t of 47 degrees of freedom passes 4 once in 4000 draws.
            assert!(z.abs() < 4.0, "{mean} {predicted} {z}");
        }
    }
}
