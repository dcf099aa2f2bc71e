//! Clocks with a constant or drifting rate.

use super::{Clock, forward};
use crate::Float;
use crate::control::error::{ensure_law, ensure_none_negative};
use crate::control::{ControlError, Jitter, StartAddress};
use crate::random::Purpose;

/// A clock whose steps all have the length `Δt`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fixed;

impl<T: Float> Clock<T> for Fixed {
    const EVEN: bool = true;

    type Memory = [T; 0];
    type Beat = ();

    fn start(&self, _: StartAddress) -> [T; 0] {
        []
    }

    fn beat(&self, _: u64) {}

    #[inline(always)]
    fn ratio(&self, _: &mut [T; 0], (): (), _: &mut impl FnMut() -> u32) -> T {
        T::one()
    }
}

/// Asynchronous clocks: steps of `1 + δ`, with another `δ` for every trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skewed(
    /// The law of `δ`.
    pub Jitter,
);

impl<T: Float> Clock<T> for Skewed {
    type Memory = [T; 1];
    type Beat = ();

    fn check(&self) -> Result<(), ControlError> {
        ensure_law::<T>("the rms of clock rates", self.0)
    }

    fn start(&self, begin: StartAddress) -> [T; 1] {
        [forward(T::from_f64(begin.draw(self.0, Purpose::ClockRate)))]
    }

    fn beat(&self, _: u64) {}

    #[inline(always)]
    fn ratio(&self, [ratio]: &mut [T; 1], (): (), _: &mut impl FnMut() -> u32) -> T {
        *ratio
    }
}

/// Asynchronous clocks whose steps are listed, one for each trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<'a>(
    /// The length of the steps of each trajectory in units of `Δt`; at least 0.
    pub &'a [f64],
);

impl<T: Float> Clock<T> for Rates<'_> {
    type Memory = [T; 1];
    type Beat = ();

    fn check(&self) -> Result<(), ControlError> {
        ensure_none_negative::<T>("clock rate", self.0)
    }

    fn start(&self, begin: StartAddress) -> [T; 1] {
        // Beyond the last are those that only fill a block.
        let rate = self.0.get(begin.trajectory() as usize).copied().unwrap_or(1.0);
        [T::from_f64(rate)]
    }

    fn beat(&self, _: u64) {}

    fn trajectories(&self) -> Option<usize> {
        Some(self.0.len())
    }

    #[inline(always)]
    fn ratio(&self, [ratio]: &mut [T; 1], (): (), _: &mut impl FnMut() -> u32) -> T {
        *ratio
    }
}

/// Drifting clocks: step `n` is `1 + n·δ` long, with another `δ` for every trajectory, counted from its beginning: of an environment,
/// from that of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drifting(
    /// The law of `δ`, the change in a step.
    pub Jitter,
);

/// Up to here any float counts.
const COUNTED: f64 = 1024.0;

impl<T: Float> Clock<T> for Drifting {
    /// `δ`, and the number of steps as `j + 1024·k`.
    type Memory = [T; 3];
    type Beat = ();

    fn check(&self) -> Result<(), ControlError> {
        ensure_law::<T>("the rms of clock drifts", self.0)
    }

    fn start(&self, begin: StartAddress) -> [T; 3] {
        [T::from_f64(begin.draw(self.0, Purpose::ClockDrift)), T::zero(), T::zero()]
    }

    fn beat(&self, _: u64) {}

    #[inline(always)]
    fn ratio(&self, [rate, j, k]: &mut [T; 3], (): (), _: &mut impl FnMut() -> u32) -> T {
        let counted = T::from_f64(COUNTED);
        let ratio = forward(*rate * *j + (*rate * counted) * *k);
        let next = *j + T::one();
        let full = next >= counted;
        *j = if full { T::zero() } else { next };
        *k = if full { *k + T::one() } else { *k };
        ratio
    }
}
