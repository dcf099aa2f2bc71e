//! Latencies drawn from a table.

use super::{Arrival, Delay};
use crate::Float;
use crate::analysis::RandomLatency;
use crate::random::{Address, Purpose, uniform};

/// In every step a latency from a table with probabilities, or with the hold probability the one of the step before: what
/// [`Plant::mean_square_late`](crate::analysis::Plant::mean_square_late) predicts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random<'a>(
    /// The table.
    pub &'a RandomLatency,
);

impl Random<'_> {
    /// The latency for a number that is uniform on (−1, 1).
    #[inline(always)]
    fn pick<T: Float>(&self, number: f32) -> T {
        let share = (f64::from(number) + 1.0) / 2.0;
        let (mut below, mut steps) = (0.0, 0.0);
        for &(latency, probability) in self.0.table() {
            // The last one whose range begins below.
            let here = probability > 0.0 && share >= below;
            steps = if here { latency as f64 } else { steps };
            below += probability;
        }
        T::from_f64(steps)
    }
}

impl<T: Float> Delay<T> for Random<'_> {
    const SPLITS: bool = false;

    /// The latency of the step before.
    type Memory = [T; 1];
    type Beat = ();

    fn longest(&self) -> usize {
        self.0.longest()
    }

    fn start(&self, seed: u64, trajectory: u64) -> [T; 1] {
        let place = Address { seed, trajectory, step: 0, purpose: Purpose::LatencyStart };
        [self.pick(uniform(place.bits()[0]))]
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        2
    }

    #[inline(always)]
    fn arrival(
        &self,
        [latency]: &mut [T; 1],
        (): (),
        word: &mut impl FnMut() -> u32,
    ) -> Arrival<T> {
        let holds = uniform(word()) < (2.0 * self.0.hold() - 1.0) as f32;
        let fresh = self.pick(uniform(word()));
        *latency = if holds { *latency } else { fresh };
        Arrival::of_age(latency.to_f64() as u32)
    }
}
