//! Actions that follow from nothing.

use core::array::from_fn;

use super::{Act, Place, Policy};
use crate::Float;
use crate::random::{UNIT, odd};
use crate::rl::EnvironmentError;
use crate::rl::start::between;

/// Uniform between two ends in each degree of freedom, drawn by address.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random<const D: usize> {
    /// The lower ends.
    pub low: [f64; D],
    /// The upper ends.
    pub high: [f64; D],
}

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for Random<D> {
    const DRAWS: bool = true;

    fn check(&self, _: usize, _: usize) -> Result<(), EnvironmentError> {
        between::check("width of the random action", self.low.into_iter().zip(self.high))?;
        Ok(())
    }

    fn words(&self) -> usize {
        D
    }

    #[inline(always)]
    fn act(&self, _: Place, _: &[T; O], word: &mut impl FnMut() -> u32) -> Act<T, D> {
        let mut log_probability = 0.0;
        let action = from_fn(|i| {
            let half = 0.5 * (self.high[i] - self.low[i]);
            log_probability -= libm::log(2.0 * half);
            let (middle, unit) = (self.low[i] + half, half * f64::from(UNIT));
            T::from_f64(middle) + T::from_f64(unit) * T::from_f64(odd(word()).into())
        });
        Act { action, log_probability: T::from_f64(log_probability) }
    }
}
