//! Sinusoidal jitter.

use core::f64::consts::{SQRT_2, TAU};

use super::{Clock, forward};
use crate::control::error::{ensure_finite, ensure_not_negative};
use crate::control::{ControlError, StartAddress};
use crate::{Elementary, Float};

/// Steps of `1 + √2·σ·sin(φn + φ₀)`: at twice the angle by which the loop turns in a step it is in resonance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinusoidal {
    /// `σ`, the root of the mean square.
    pub rms: f64,
    /// `φ`, radians a step.
    pub rate: f64,
    /// `φ₀`, radians.
    pub phase: f64,
}

impl<T: Float> Clock<T> for Sinusoidal {
    type Memory = [T; 0];
    type Beat = T;

    fn check(&self) -> Result<(), ControlError> {
        ensure_not_negative::<T>("the rms of waving steps", self.rms)?;
        ensure_finite::<T>("the rate of waving steps", self.rate)?;
        ensure_finite::<T>("the phase of waving steps", self.phase)
    }

    fn start(&self, _: StartAddress) -> [T; 0] {
        []
    }

    fn beat(&self, step: u64) -> T {
        // In turns, of which whole ones do not count.
        let turns = self.rate % TAU / TAU * step as f64;
        let angle = TAU * turns.fract() + self.phase % TAU;
        T::from_f64(SQRT_2 * self.rms * Elementary::sin(angle))
    }

    #[inline(always)]
    fn ratio(&self, _: &mut [T; 0], beat: T, _: &mut impl FnMut() -> u32) -> T {
        forward(beat)
    }
}
