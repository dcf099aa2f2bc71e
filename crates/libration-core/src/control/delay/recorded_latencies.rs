//! Recorded latencies.

use thiserror::Error;

use super::{Arrival, Delay};
use crate::Float;
use crate::control::{Latency, StartAddress};

/// A latency for each step, the same for all trajectories: in step `k` the command of `⌊latency⌋` steps ago arrives, after
/// the part of the step that is left. A run that is longer than the record is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedLatencies<'a>(&'a [f64]);

/// Error of a record of latencies.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "latency {index} is {value} steps; it must be at least 0 and at most {}",
    Latency::MOST_STEPS
)]
pub struct RecordedLatenciesError {
    /// The index, from 0.
    pub index: usize,
    /// In steps.
    pub value: f64,
}

impl<'a> RecordedLatencies<'a> {
    /// A record of latencies in steps.
    ///
    /// # Errors
    /// If one is not a number, negative or too large.
    pub fn new(latencies: &'a [f64]) -> Result<Self, RecordedLatenciesError> {
        match latencies.iter().position(|&steps| Latency::of_steps(steps).is_none()) {
            Some(index) => Err(RecordedLatenciesError { index, value: latencies[index] }),
            None => Ok(RecordedLatencies(latencies)),
        }
    }
}

impl<T: Float> Delay<T> for RecordedLatencies<'_> {
    const SPLITS: usize = 1;

    type Memory = [T; 0];
    /// Whole steps, and the part of another.
    type Beat = (u32, T);

    fn longest(&self) -> usize {
        self.0.iter().fold(0.0_f64, |most, &steps| most.max(steps)) as usize
    }

    fn start(&self, _: StartAddress) -> [T; 0] {
        []
    }

    fn beat(&self, step: u64) -> (u32, T) {
        let steps = usize::try_from(step).ok().and_then(|step| self.0.get(step));
        let steps = steps.copied().unwrap_or(0.0);
        (steps as u32, T::from_f64(steps.fract()))
    }

    fn steps(&self) -> Option<u64> {
        Some(self.0.len() as u64)
    }

    #[inline(always)]
    fn arrival(
        &self,
        _: &mut [T; 0],
        (age, part): (u32, T),
        _: &mut impl FnMut() -> u32,
    ) -> Arrival<T> {
        Arrival { fresh: true, age, part, looks: T::zero() }
    }
}
