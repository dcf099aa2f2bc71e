//! A latency for each trajectory.

use super::{Arrival, Delay};
use crate::Float;
use crate::analysis::Latency;

/// Latencies of the command, one for each trajectory, of any length: steps split where commands arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latencies<'a>(
    /// Of every trajectory.
    pub &'a [Latency],
);

impl<T: Float> Delay<T> for Latencies<'_> {
    const SPLITS: bool = true;

    /// Whole steps, and the part of another.
    type Memory = [T; 2];
    type Beat = ();

    fn longest(&self) -> usize {
        self.0.iter().map(|latency| latency.steps().trunc() as usize).max().unwrap_or(0)
    }

    fn start(&self, _: u64, trajectory: u64) -> [T; 2] {
        // Beyond the last are those that only fill a block.
        let steps = self.0.get(trajectory as usize).map_or(0.0, |latency| latency.steps());
        [steps.trunc(), steps.fract()].map(T::from_f64)
    }

    fn beat(&self, _: u64) {}

    fn trajectories(&self) -> Option<usize> {
        Some(self.0.len())
    }

    #[inline(always)]
    fn arrival(
        &self,
        &mut [whole, part]: &mut [T; 2],
        (): (),
        _: &mut impl FnMut() -> u32,
    ) -> Arrival<T> {
        Arrival { fresh: true, age: whole.to_f64() as u32, part }
    }
}
