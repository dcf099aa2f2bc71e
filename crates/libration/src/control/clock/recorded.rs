//! Steps that were measured.

use thiserror::Error;

use super::Clock;
use crate::Float;

/// The steps between the time stamps of a loop that ran.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recorded<'a> {
    ratios: &'a [f64],
    repeats: bool,
}

/// Why time stamps are no record of a clock.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RecordedError {
    /// There is no step between them.
    #[error("{count} time stamps: there must be at least 2")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// One is infinite or not a number.
    #[error("time stamp {index} is {value}: it must be a number")]
    NotFinite {
        /// Which, from 0 on.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// A clock does not go back.
    #[error("time stamp {index} is {after} s, before the {before} s of the one in front of it")]
    Backwards {
        /// Which, from 0 on.
        index: usize,
        /// The one in front of it, in seconds.
        before: f64,
        /// It, in seconds.
        after: f64,
    },
    /// Something is needed that is above zero.
    #[error("the mean step is {mean} s: it must be above 0")]
    NoTime {
        /// The mean step in seconds.
        mean: f64,
    },
}

impl<'a> Recorded<'a> {
    /// The steps between `stamps`, which are in seconds, as multiples of their mean; and that mean in seconds.
    ///
    /// # Errors
    /// If there are fewer than two stamps, if one is not a number or lies before the one in front of it, or if all are
    /// the same.
    pub fn steps_between(stamps: &[f64]) -> Result<(Vec<f64>, f64), RecordedError> {
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
        Ok((stamps.windows(2).map(|pair| (pair[1] - pair[0]) / mean).collect(), mean))
    }

    /// These steps, as multiples of `Δt`, for all trajectories. A run that is longer is refused.
    pub fn once(ratios: &'a [f64]) -> Self {
        Recorded { ratios, repeats: false }
    }

    /// These steps, again and again; there must be at least one.
    pub fn repeated(ratios: &'a [f64]) -> Self {
        Recorded { ratios, repeats: true }
    }
}

impl<T: Float> Clock<T> for Recorded<'_> {
    type Memory = [T; 0];
    type Beat = T;

    fn start(&self, _: u64, _: u64) -> [T; 0] {
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
