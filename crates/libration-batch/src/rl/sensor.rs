//! Sensors: errors of observations.

use libration_core::Float;
use libration_core::control::ControlError;
use libration_core::control::clock::Noise;
use libration_core::control::error::ensure_not_negative;

/// A sensor that measures the `O` numbers of an observation.
pub trait Sensor<T: Float, const O: usize>: Copy + Send + Sync {
    /// Whether the sensor draws random words.
    const DRAWS: bool;

    /// Checks the parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// The number of random words per measurement, always the same.
    fn words(&self) -> usize;

    /// The measured numbers. An implementation branches on values of `self` only and is `#[inline(always)]`; otherwise the loops
    /// over environments are not vectorised.
    fn measure(&self, seen: [T; O], word: &mut impl FnMut() -> u32) -> [T; O];
}

/// A sensor without error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exact;

impl<T: Float, const O: usize> Sensor<T, O> for Exact {
    const DRAWS: bool = false;

    fn words(&self) -> usize {
        0
    }

    #[inline(always)]
    fn measure(&self, seen: [T; O], _: &mut impl FnMut() -> u32) -> [T; O] {
        seen
    }
}

/// Noise on every number, each with its own law, independent of all others and from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noisy<N, const O: usize>(
    /// The laws.
    pub [N; O],
);

impl<T: Float, N: Noise, const O: usize> Sensor<T, O> for Noisy<N, O> {
    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        let each = self.0.iter().enumerate().map(|(index, noise)| {
            let found =
                ensure_not_negative::<T>("the rms of the noise of observation", noise.law().rms());
            found.map_err(|error| ControlError { index: Some(index), ..error })
        });
        each.collect()
    }

    fn words(&self) -> usize {
        self.0.iter().map(Noise::words).sum()
    }

    #[inline(always)]
    fn measure(&self, mut seen: [T; O], word: &mut impl FnMut() -> u32) -> [T; O] {
        for (number, noise) in seen.iter_mut().zip(&self.0) {
            *number = *number + noise.draw(word);
        }
        seen
    }
}
