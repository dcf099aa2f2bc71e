//! Random actions.

use libration_core::Float;
use libration_core::array::each;
use libration_core::control::error::ensure_finite;
use libration_core::random::{UNIT, odd};

use super::{ActionSample, Policy, StepIndex};
use crate::rl::EnvironmentError;

/// Uniform between two ends in each degree of freedom, drawn by address.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random<const D: usize> {
    low: [f64; D],
    high: [f64; D],
    /// The log-probability of every action, computed once.
    log_probability: f64,
}

impl<const D: usize> Random<D> {
    /// A policy that draws uniformly between `low` and `high`.
    pub fn between(low: [f64; D], high: [f64; D]) -> Self {
        let widths = low.iter().zip(&high).map(|(low, high)| high - low);
        Random { low, high, log_probability: -widths.map(libm::log).sum::<f64>() }
    }
}

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for Random<D> {
    const CLOSED_FORM: bool = true;
    const DRAWS: bool = true;

    fn check(&self, _: usize, _: usize) -> Result<(), EnvironmentError> {
        for (index, (low, high)) in self.low.into_iter().zip(self.high).enumerate() {
            EnvironmentError::above_zero::<T>("width of the random action", index, high - low)?;
            ensure_finite::<T>("lower end of the random action", low)?;
            ensure_finite::<T>("upper end of the random action", high)?;
        }
        Ok(())
    }

    fn uses_observations(&self) -> bool {
        false
    }

    fn words(&self) -> usize {
        D
    }

    #[inline(always)]
    fn act(&self, _: StepIndex, _: &[T; O], word: &mut impl FnMut() -> u32) -> ActionSample<T, D> {
        let action = each(|i| {
            let half = 0.5 * (self.high[i] - self.low[i]);
            let (middle, unit) = (self.low[i] + half, half * f64::from(UNIT));
            T::from_f64(middle) + T::from_f64(unit) * T::from_f64(odd(word()).into())
        });
        ActionSample { action, log_probability: T::from_f64(self.log_probability) }
    }
}
