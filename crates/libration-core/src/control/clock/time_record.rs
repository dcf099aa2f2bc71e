//! Recorded clocks.

use thiserror::Error;

use super::Clock;
use crate::Float;
use crate::control::error::{ensure, ensure_none_negative};
use crate::control::{ControlError, StartAddress};

/// The steps between the time stamps of a loop that ran.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recorded<'a> {
    ratios: &'a [f64],
    repeats: bool,
}

/// Error of a record of time stamps.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RecordedError {
    /// There are fewer than two time stamps.
    #[error("the number of time stamps is {count}; it must be at least 2")]
    TooFew {
        /// The number of time stamps.
        count: usize,
    },
    /// A time stamp is not finite.
    #[error("time stamp {} is {value}; it must be a finite number", index + 1)]
    NotFinite {
        /// The index, from 0; the message counts from 1.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A time stamp is before the preceding one.
    #[error("time stamp {} is {after} s; it must be at least the {before} s of the preceding one, counted from the first", index + 1)]
    Backwards {
        /// The index, from 0; the message counts from 1.
        index: usize,
        /// The preceding time stamp, in seconds.
        before: f64,
        /// The time stamp, in seconds.
        after: f64,
    },
    /// The mean step is not above zero.
    #[error("the mean step is {mean} s; it must be a finite number above 0")]
    NoTime {
        /// The mean step in seconds.
        mean: f64,
    },
}

impl<'a> Recorded<'a> {
    /// The steps between `stamps`, which are in seconds, as multiples of `dt` seconds.
    ///
    /// # Errors
    /// As for [`Recorded::steps_between`]; and if `dt` is not above zero.
    pub fn steps_in(stamps: &[f64], dt: f64) -> Result<Vec<f64>, RecordedError> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(RecordedError::NoTime { mean: dt });
        }
        Self::mean_step(stamps)?;
        Ok(stamps.windows(2).map(|pair| (pair[1] - pair[0]) / dt).collect())
    }

    /// The steps between `stamps`, which are in seconds, as multiples of their mean; and that mean in seconds.
    ///
    /// # Errors
    /// If there are fewer than two stamps, if one is not a number or lies before the one in front of it, or if all are
    /// the same.
    pub fn steps_between(stamps: &[f64]) -> Result<(Vec<f64>, f64), RecordedError> {
        let mean = Self::mean_step(stamps)?;
        Ok((Self::steps_in(stamps, mean)?, mean))
    }

    /// The mean step in seconds.
    fn mean_step(stamps: &[f64]) -> Result<f64, RecordedError> {
        if let Some(index) = stamps.iter().position(|stamp| !stamp.is_finite()) {
            return Err(RecordedError::NotFinite { index, value: stamps[index] });
        }
        let back = stamps.windows(2).position(|pair| pair[1] < pair[0]);
        if let Some(i) = back {
            let (before, after) = (stamps[i], stamps[i + 1]);
            return Err(RecordedError::Backwards { index: i + 1, before, after });
        }
        let (&[first, ..], &[.., last]) = (stamps, stamps) else {
            return Err(RecordedError::TooFew { count: 0 });
        };
        if stamps.len() < 2 {
            return Err(RecordedError::TooFew { count: stamps.len() });
        }
        let mean = (last - first) / (stamps.len() - 1) as f64;
        if !(mean > 0.0 && mean.is_finite()) {
            return Err(RecordedError::NoTime { mean });
        }
        Ok(mean)
    }

    /// A record of steps in units of `Δt`, for all trajectories. A longer run fails.
    pub fn once(ratios: &'a [f64]) -> Self {
        Recorded { ratios, repeats: false }
    }

    /// A record that repeats; it must have at least one step.
    pub fn repeated(ratios: &'a [f64]) -> Self {
        Recorded { ratios, repeats: true }
    }
}

impl<T: Float> Clock<T> for Recorded<'_> {
    type Memory = [T; 0];
    type Beat = T;

    fn check(&self) -> Result<(), ControlError> {
        ensure_none_negative::<T>("recorded step", self.ratios)?;
        let count = self.ratios.len() as f64;
        ensure("the number of recorded steps", count, "at least 1", |count| count > 0.0)
    }

    fn start(&self, _: StartAddress) -> [T; 0] {
        []
    }

    fn beat(&self, step: u64) -> T {
        let index = step.checked_rem(self.ratios.len() as u64).unwrap_or(0);
        let ratio = self.ratios.get(index as usize).copied().unwrap_or(0.0);
        T::from_f64(ratio.max(0.0))
    }

    fn steps(&self) -> Option<u64> {
        (!self.repeats || self.ratios.is_empty()).then_some(self.ratios.len() as u64)
    }

    #[inline(always)]
    fn ratio(&self, _: &mut [T; 0], beat: T, _: &mut impl FnMut() -> u32) -> T {
        beat
    }
}
