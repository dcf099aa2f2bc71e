//! Lengths of the steps of a block.

use libration_core::Float;
use libration_core::control::{Clock, Memory};
use libration_core::random::Streams;

use super::block::{BlockOf, ClockMemory};
use super::block_size::LANES;
use super::deviation::scale_deviation;
use super::stepper::Stepper;
use super::{Policy, World};
use crate::ensemble::kernel::Lines;

impl<T, E, P, const O: usize, const D: usize> Stepper<'_, T, E, P, O, D>
where
    T: Float,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    /// The length of the step of lane `l`, in units of `Δt`.
    #[inline(always)]
    pub(super) fn ratio(
        &self,
        block: &mut BlockOf<T, E, O, D>,
        l: usize,
        beat: <E::Clock as Clock<T>>::Beat,
        words: &mut Streams<LANES>,
    ) -> T {
        let clock = self.parts().clock;
        let mut memory = ClockMemory::<T, E, O, D>::lane(&block.clock, l);
        let mut ratio = clock.ratio(&mut memory, beat, &mut || words.next(l));
        if const { !E::Clock::EVEN } {
            ratio = scale_deviation(ratio, T::one(), block.error_scale[0][l]);
            ratio = if ratio < T::zero() { T::zero() } else { ratio };
        }
        ClockMemory::<T, E, O, D>::set_lane(&mut block.clock, l, memory);
        ratio
    }

    /// The length of the step of each lane.
    #[inline(always)]
    pub(super) fn lengths(
        &self,
        block: &mut BlockOf<T, E, O, D>,
        beat: <E::Clock as Clock<T>>::Beat,
        words: &mut Streams<LANES>,
    ) -> Lines<[T; LANES]> {
        let mut dt = Lines([self.dt; LANES]);
        if const { !E::Clock::EVEN } {
            for l in 0..LANES {
                dt.0[l] = self.dt * self.ratio(block, l, beat, words);
            }
        }
        dt
    }
}
