//! The events of a period of a loop in order.

use crate::phases::{merged, same};
use crate::{LinearLoop, LinearLoopError, LoopTiming};

/// The events at one phase of a period: first outputs are measured, then commands take over.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodEvents {
    /// The phase, from 0 to 1.
    pub phase: f64,
    /// The outputs that are measured. Those measured at the beginning of a period, before the controller runs, are not listed.
    pub measured: Vec<usize>,
    /// The inputs at which a command takes over.
    pub arriving: Vec<usize>,
}

impl LinearLoop {
    /// The events of a period by rising phase; the first are those at 0 and the last those at 1.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub fn period_events(&self, timing: &LoopTiming) -> Result<Vec<PeriodEvents>, LinearLoopError> {
        self.check_timing(timing)?;
        let arrives: Vec<f64> = timing.input_latency.iter().map(|late| late.part()).collect();
        // NaN is the same as no phase.
        let measured: Vec<f64> = timing
            .output_latency
            .iter()
            .map(|late| if late.part() > 0.0 { 1.0 - late.part() } else { f64::NAN })
            .collect();
        let all = arrives.iter().chain(&measured).copied().filter(|phase| !phase.is_nan());
        let at = |phases: &[f64], phase: f64| {
            (0..phases.len()).filter(|&i| same(phases[i], phase)).collect::<Vec<_>>()
        };
        let events = |phase: f64| PeriodEvents {
            phase,
            measured: at(&measured, phase),
            arriving: at(&arrives, phase),
        };
        Ok(merged(all.chain([0.0, 1.0]).collect()).into_iter().map(events).collect())
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::Latency;

    use super::*;
    use crate::{DiscreteController, LinearPlant, Matrix};

    #[test]
    fn commands_take_over_after_their_part_and_measurements_precede_the_end_by_theirs() {
        let a = Matrix::zeros(1, 1);
        let plant =
            LinearPlant::new(a, Matrix::zeros(1, 2), Matrix::zeros(3, 1), Matrix::zeros(3, 2));
        let controller = DiscreteController::gain(Matrix::zeros(2, 3));
        let linear =
            LinearLoop::new(plant.unwrap(), controller, 0.1, Matrix::zeros(3, 3), vec![0.0; 3]);
        let linear = linear.unwrap();
        let late = |steps: &[f64]| {
            steps.iter().map(|&steps| Latency::of_steps(steps).unwrap()).collect::<Vec<_>>()
        };
        let timing = LoopTiming {
            input_latency: late(&[1.25, 2.0]),
            output_latency: late(&[0.75, 3.0, 0.5]),
            ..linear.ideal()
        };
        let found = linear.period_events(&timing).unwrap();
        let event = |phase, measured: &[usize], arriving: &[usize]| PeriodEvents {
            phase,
            measured: measured.to_vec(),
            arriving: arriving.to_vec(),
        };
        let wanted = [
            event(0.0, &[], &[1]),
            event(0.25, &[0], &[0]),
            event(0.5, &[2], &[]),
            event(1.0, &[], &[]),
        ];
        assert_eq!(found, wanted);
    }
}
