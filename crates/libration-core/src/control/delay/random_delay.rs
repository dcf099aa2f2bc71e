//! Random latencies from a table.

use super::{Arrival, Delay};
use crate::Float;
use crate::control::{RandomLatency, StartAddress};
use crate::random::{Purpose, uniform};

/// In every step a latency from a table with probabilities, or with the hold probability the one of the step before: what
/// `Plant::mean_square_late` predicts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random<'a>(
    /// The table.
    pub &'a RandomLatency,
);

impl Random<'_> {
    /// The entry for a number that is uniform on (−1, 1).
    #[inline(always)]
    fn pick<T: Float>(&self, number: f32) -> T {
        let share = (f64::from(number) + 1.0) / 2.0;
        let (mut below, mut entry) = (0.0, 0.0);
        for (i, &(_, probability)) in self.0.table().iter().enumerate() {
            // The last one whose range begins below.
            let here = probability > 0.0 && share >= below;
            entry = if here { i as f64 } else { entry };
            below += probability;
        }
        T::from_f64(entry)
    }
}

impl<T: Float> Delay<T> for Random<'_> {
    const SPLITS: usize = 1;

    /// The entry of the step before.
    type Memory = [T; 1];
    type Beat = ();

    fn longest(&self) -> usize {
        self.0.longest()
    }

    fn start(&self, begin: StartAddress) -> [T; 1] {
        [self.pick(uniform(begin.address(Purpose::LatencyStart).bits()[0]))]
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        2
    }

    #[inline(always)]
    fn arrival(&self, [entry]: &mut [T; 1], (): (), word: &mut impl FnMut() -> u32) -> Arrival<T> {
        let holds = uniform(word()) < (2.0 * self.0.hold() - 1.0) as f32;
        let fresh = self.pick(uniform(word()));
        *entry = if holds { *entry } else { fresh };
        let (mut age, mut part) = (0, 0.0);
        for (i, (latency, _)) in self.0.table().iter().enumerate() {
            let this = entry.to_f64() == i as f64;
            age = if this { latency.whole() as u32 } else { age };
            part = if this { latency.part() } else { part };
        }
        Arrival { part: T::from_f64(part), ..Arrival::of_age(age) }
    }
}
