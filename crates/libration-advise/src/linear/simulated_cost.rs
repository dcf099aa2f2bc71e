//! The cost of a loop around a linear plant, simulated.

use libration::linear::Simulation;
use libration_work::Work;

use super::LinearRequest;
use crate::AdviseError;
use crate::combined_effect::SimulatedCost;
use crate::ensemble::{FORGOTTEN, MEMORIES};
use crate::loops::LoopError;

/// Number of simulated loops.
const COUNT: u64 = 64;

/// Multiplications, about one per nanosecond, beyond which half as many loops take half as many measured periods.
const MANY: f64 = 4e9;

/// Terms of a series that moves the plant through a period.
const TERMS: f64 = 20.0;

/// Seed of all random numbers.
const SEED: u64 = 30;

/// Largest number of simulated periods of a loop.
const MOST_PERIODS: f64 = 20_000.0;

impl LinearRequest {
    /// The cost of loops with all stated imperfections under noise that is held through each period; none if they decay too slowly.
    pub(super) fn simulated_cost(
        &self,
        work: &Work<'_>,
        growth: f64,
    ) -> Result<Option<SimulatedCost>, AdviseError> {
        let memory = MEMORIES / -growth;
        if memory > MOST_PERIODS {
            return Ok(None);
        }
        let timing = self.timed.stated().map_err(LoopError::from)?;
        let record = self.timed.timing.record.as_deref();
        let linear = &self.timed.linear;
        let simulation = Simulation { linear, timing: &timing, record, seed: SEED };
        let before = (FORGOTTEN * memory).ceil() as u64;
        let periods = (4.0 * memory).clamp(1000.0, 0.5 * MOST_PERIODS) as u64;
        let size = linear.plant().states.len() as f64;
        let work_of_all = COUNT as f64 * (before + periods) as f64 * TERMS * size * size;
        let half = if work_of_all > MANY { 2 } else { 1 };
        // Whole rounds of a cascade.
        let round = linear.controllers().periods() as u64;
        let periods = (periods / half).next_multiple_of(round);
        let numbers: Vec<u64> = (0..COUNT / half).collect();
        let costs = work.sweep("simulated loops", &numbers, |&number| {
            Ok::<f64, AdviseError>(simulation.mean_cost(number, before, periods))
        })?;
        let held = self.timed.with_held_noise();
        let predicted = held.cost(&timing).map_err(LoopError::from)?;
        Ok(Some(SimulatedCost::new(&costs, 1, periods, predicted)))
    }
}
