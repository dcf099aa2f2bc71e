//! Disturbances: accelerations besides the command.

use super::ControlError;
use super::error::ensure_not_negative;
use crate::Float;
use crate::random::normal;

/// A disturbance: process noise as an acceleration.
pub trait Disturbance: Copy + Send + Sync {
    /// Whether the disturbance is not zero.
    #[doc(hidden)]
    const ACTS: bool = true;

    /// Checks the parameters; `Loops` call it before they begin.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check<T: Float>(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// The number of random words per acceleration, the same for every step and trajectory.
    fn words(&self) -> usize;

    /// The acceleration in a degree of freedom that is held through a step of `dt` seconds, whether a command arrives within it
    /// or not.
    fn acceleration<T: Float>(&self, dt: T, word: &mut impl FnMut() -> u32) -> T;
}

/// No disturbance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoDisturbance;

impl Disturbance for NoDisturbance {
    const ACTS: bool = false;

    fn words(&self) -> usize {
        0
    }

    #[inline(always)]
    fn acceleration<T: Float>(&self, _: T, _: &mut impl FnMut() -> u32) -> T {
        T::zero()
    }
}

/// White Gaussian noise of intensity `W`, in (m/s²)²·s, independent in each degree of freedom: an acceleration with the variance
/// `W/Δt` that is held through each step, so that the velocity takes up the variance `W` in a second, whatever the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhiteNoise(pub f64);

impl Disturbance for WhiteNoise {
    fn check<T: Float>(&self) -> Result<(), ControlError> {
        ensure_not_negative::<T>("the intensity of the noise", self.0)
    }

    fn words(&self) -> usize {
        2
    }

    #[inline(always)]
    fn acceleration<T: Float>(&self, dt: T, word: &mut impl FnMut() -> u32) -> T {
        let drawn = T::from_f64(self.0.sqrt()) * T::from_f64(normal([word(), word()]).into());
        // A step of length zero moves nothing.
        let root = dt.sqrt();
        let share = if root > T::zero() { root.recip() } else { T::zero() };
        drawn * share
    }
}
