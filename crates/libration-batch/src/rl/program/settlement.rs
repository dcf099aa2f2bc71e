//! Rewards and flags of a step, from its verdict.

use libration_core::Float;

use super::block_state::Row;
use crate::ensemble::Loop;
use crate::rl::block::LOST;
use crate::rl::block_size::LANES;

/// What becomes of the verdict of a step.
///
/// A step that is not finite is [`LOST`] and has reward 0: a number that is not finite times zero is not zero.
pub(super) struct Settlement<'a, T> {
    /// Rewards, and what is positive where an episode is over.
    pub(super) judged: &'a [Row<T>; 2],
    /// Rows that must be finite.
    pub(super) finite: [&'a [Row<T>]; 2],
    pub(super) rewards: &'a mut Row<T>,
    /// The returns of the episodes, to which the rewards are added.
    pub(super) paid: &'a mut Row<T>,
    pub(super) overs: &'a mut [u8; LANES],
}

impl<T: Float> Loop for Settlement<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [rewards, overs] = self.judged;
        let Sums(none) = &mut Sums(*rewards);
        none.iter_mut().for_each(|none| *none = *none * T::zero());
        for row in self.finite.into_iter().flatten() {
            for (none, &x) in none.iter_mut().zip(row) {
                *none = *none + x * T::zero();
            }
        }
        for l in 0..LANES {
            let lost = none[l] != T::zero();
            self.overs[l] = u8::from(overs[l] > T::zero()) | (u8::from(lost) * LOST);
            let reward = if lost { T::zero() } else { rewards[l] };
            self.rewards[l] = reward;
            self.paid[l] = self.paid[l] + reward;
        }
    }
}

/// Sums that are read back as soon as they are written: across two lines of the cache that takes several times as long.
#[repr(align(64))]
struct Sums<T>(Row<T>);
