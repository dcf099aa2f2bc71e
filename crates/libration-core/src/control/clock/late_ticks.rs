//! Clocks with late ticks.

use super::{Clock, forward};
use crate::Float;
use crate::control::error::{ensure, ensure_probability};
use crate::control::{ControlError, StartAddress};
use crate::random::{Purpose, uniform};

/// A clock whose ticks come late by a random time and do not pass it on: a long step is followed by a short one, as
/// of a timer with absolute deadlines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateTicks {
    /// The probability that a tick is late.
    pub probability: f64,
    /// The lateness in units of `Δt`, from 0 to 1; a later tick would pass the next one.
    pub by: f64,
}

impl LateTicks {
    /// The lateness of a tick.
    #[inline(always)]
    fn lateness<T: Float>(&self, number: f32) -> T {
        let late = number < (2.0 * self.probability - 1.0) as f32;
        T::from_f64(if late { self.by } else { 0.0 })
    }
}

impl<T: Float> Clock<T> for LateTicks {
    type Memory = [T; 1];
    type Beat = ();

    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        ensure_probability("the probability of a late tick", self.probability)?;
        ensure("the lateness of a tick", self.by, "from 0 to 1", |by| (0.0..=1.0).contains(&by))
    }

    fn start(&self, begin: StartAddress) -> [T; 1] {
        [self.lateness(uniform(begin.address(Purpose::ClockStart).bits()[0]))]
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        1
    }

    #[inline(always)]
    fn ratio(&self, [late]: &mut [T; 1], (): (), word: &mut impl FnMut() -> u32) -> T {
        let next = self.lateness(uniform(word()));
        let longer = next - *late;
        *late = next;
        forward(longer)
    }
}
