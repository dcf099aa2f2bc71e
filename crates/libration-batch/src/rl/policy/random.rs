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
        Random { low, high, log_probability: log_probability(&low, &high) }
    }
}

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for Random<D> {
    const CLOSED_FORM: bool = true;
    const DRAWS: bool = true;

    fn check(&self, _: usize, _: usize) -> Result<(), EnvironmentError> {
        check::<T>(&self.low, &self.high)
    }

    fn uses_observations(&self) -> bool {
        false
    }

    fn words(&self) -> usize {
        D
    }

    #[inline(always)]
    fn act(&self, _: StepIndex, _: &[T; O], word: &mut impl FnMut() -> u32) -> ActionSample<T, D> {
        let action = each(|i| between(self.low[i], self.high[i], word()));
        ActionSample { action, log_probability: T::from_f64(self.log_probability) }
    }
}

/// Returns an error unless every lower end is below its upper one.
pub(in crate::rl) fn check<T: Float>(low: &[f64], high: &[f64]) -> Result<(), EnvironmentError> {
    for (index, (&low, &high)) in low.iter().zip(high).enumerate() {
        EnvironmentError::above_zero::<T>("width of the random action", index, high - low)?;
        ensure_finite::<T>("lower end of the random action", low)?;
        ensure_finite::<T>("upper end of the random action", high)?;
    }
    Ok(())
}

/// The logarithm of the probability density of an action.
pub(in crate::rl) fn log_probability(low: &[f64], high: &[f64]) -> f64 {
    let widths = low.iter().zip(high).map(|(low, high)| high - low);
    -widths.map(libm::log).sum::<f64>()
}

/// The number between two ends that a random word draws.
#[inline(always)]
pub(in crate::rl) fn between<T: Float>(low: f64, high: f64, word: u32) -> T {
    let half = 0.5 * (high - low);
    let (middle, unit) = (low + half, half * f64::from(UNIT));
    T::from_f64(middle) + T::from_f64(unit) * T::from_f64(odd(word).into())
}
