//! Autoregressive jitter.

use super::{Clock, Gaussian, Noise, forward};
use crate::Float;
use crate::control::error::{ensure, ensure_not_negative};
use crate::control::{ControlError, Jitter, StartAddress};
use crate::random::Purpose;

/// Steps of `1 + ε`, where `ε` is an autoregressive process of first order: `εₙ₊₁ = φ·εₙ + √(1 − φ²)·σ·ξ` with
/// Gaussian `ξ`, stationary from the first step on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlated {
    /// `σ`, the standard deviation of `ε`.
    pub rms: f64,
    /// `φ`, the correlation of neighbouring steps, between −1 and 1.
    pub correlation: f64,
}

impl<T: Float> Clock<T> for Correlated {
    type Memory = [T; 1];
    type Beat = ();

    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        ensure_not_negative::<T>("the rms of correlated steps", self.rms)?;
        let within = |x: f64| (-1.0..=1.0).contains(&x);
        ensure("the correlation of steps", self.correlation, "from -1 to 1", within)
    }

    fn start(&self, begin: StartAddress) -> [T; 1] {
        let law = Jitter::Gaussian(self.rms);
        [T::from_f64(begin.draw(law, Purpose::ClockStart))]
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        2
    }

    #[inline(always)]
    fn ratio(&self, [epsilon]: &mut [T; 1], (): (), word: &mut impl FnMut() -> u32) -> T {
        let now = *epsilon;
        let fresh = (1.0 - self.correlation * self.correlation).sqrt() * self.rms;
        *epsilon = T::from_f64(self.correlation) * now + Gaussian(fresh).draw::<T>(word);
        forward(now)
    }
}
