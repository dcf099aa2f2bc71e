//! Ticks that come late.

use super::{Clock, forward};
use crate::Float;
use crate::control::ControlError;
use crate::control::error::{not_negative, probability};
use crate::random::{Address, Purpose, uniform};

/// A clock whose ticks come late by a random time and do not pass it on: a long step is followed by a short one, as
/// of a timer with absolute deadlines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Late {
    /// The probability that a tick is late.
    pub probability: f64,
    /// By how many `Δt` it then is, at least 0. Steps are not negative as long as this is at most 1.
    pub by: f64,
}

impl Late {
    /// How late a tick is.
    #[inline(always)]
    fn lateness<T: Float>(&self, number: f32) -> T {
        let late = number < (2.0 * self.probability - 1.0) as f32;
        T::from_f64(if late { self.by } else { 0.0 })
    }
}

impl<T: Float> Clock<T> for Late {
    type Memory = [T; 1];
    type Beat = ();

    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        probability("the probability of a late tick", self.probability)?;
        not_negative("the lateness of a tick", self.by)
    }

    fn start(&self, seed: u64, trajectory: u64) -> [T; 1] {
        let place = Address { seed, trajectory, step: 0, purpose: Purpose::ClockStart };
        [self.lateness(uniform(place.bits()[0]))]
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
