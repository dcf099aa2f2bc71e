//! Clocks with missed ticks.

use super::Clock;
use crate::Float;
use crate::control::error::ensure;
use crate::control::{ControlError, StartAddress};
use crate::random::uniform;

/// A clock of which each tick is missed with a probability: no time passes in that step, and the next one that is
/// not missed makes up for it. Of time nothing is lost, so that a run of missed ticks is followed by one long step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissedTicks {
    /// The probability of a missed tick, at least 0 and below 1.
    pub probability: f64,
}

impl<T: Float> Clock<T> for MissedTicks {
    type Memory = [T; 1];
    type Beat = ();

    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        let below_one = |p: f64| (0.0..1.0).contains(&p);
        ensure(
            "the probability of a missed tick",
            self.probability,
            "at least 0 and below 1",
            below_one,
        )
    }

    fn start(&self, _: StartAddress) -> [T; 1] {
        [T::zero()]
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        1
    }

    #[inline(always)]
    fn ratio(&self, [owed]: &mut [T; 1], (): (), word: &mut impl FnMut() -> u32) -> T {
        // The word is uniform on (−1, 1).
        let missed = uniform(word()) < (2.0 * self.probability - 1.0) as f32;
        let due = *owed + T::one();
        *owed = if missed { due } else { T::zero() };
        if missed { T::zero() } else { due }
    }
}
