//! What is not as it should be: lengths of steps, commands, measurements.

use libration_core::control::{Clock, Memory};
use libration_core::random::Streams;
use libration_core::{Float, Integrator, System};

use super::block::{BlockOf, ClockMemory};
use super::block_size::LANES;
use super::deviation::worse;
use super::stage::Stage;
use super::{Policy, Variation, World};
use crate::ensemble::Assign;
use crate::ensemble::kernel::Lines;

impl<T, E, P, const O: usize, const D: usize> Stage<'_, T, E, P, O, D>
where
    T: Float,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    /// Whether a loop over lanes is made when the system and the integrator are known.
    pub(super) const CHOSEN: bool = {
        let chosen = <E::System as System<T, D>>::CHOSEN || E::Method::CHOSEN;
        chosen && E::Systems::UNIFORM && E::Variation::SAME
    };

    /// How many `Δt` the step of lane `l` is long.
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
            ratio = worse(ratio, T::one(), block.severity[0][l]);
            ratio = if ratio < T::zero() { T::zero() } else { ratio };
        }
        ClockMemory::<T, E, O, D>::set_lane(&mut block.clock, l, memory);
        ratio
    }

    /// How long the step of each lane is.
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

    /// Whether commands are accelerations without a limit.
    #[inline(always)]
    pub(super) fn is_free(&self) -> bool {
        self.saturation.to_f64() == f64::INFINITY && self.is_per_mass()
    }

    /// Whether commands are accelerations as they are.
    #[inline(always)]
    fn is_per_mass(&self) -> bool {
        self.mobility == T::one()
    }

    /// What these commands accelerate by.
    #[inline(always)]
    pub(super) fn accelerations(&self, commands: &[[T; LANES]; D]) -> [[T; LANES]; D] {
        let mut accelerations = *commands;
        if self.is_per_mass() {
            return accelerations;
        }
        for row in &mut accelerations {
            for x in row {
                *x = *x * self.mobility;
            }
        }
        accelerations
    }

    /// What is to be had of these actions. What is no number stays none.
    #[inline(always)]
    pub(super) fn commands(&self, actions: &[[T; LANES]; D]) -> [[T; LANES]; D] {
        let mut commands = *actions;
        if self.is_free() {
            return commands;
        }
        let most = self.saturation;
        for row in &mut commands {
            for x in row {
                let low = if *x < -most { -most } else { *x };
                *x = if low > most { most } else { low };
            }
        }
        commands
    }
}
