//! Clocks with independent jitter.

use super::{Clock, Noise, forward};
use crate::Float;
use crate::control::error::ensure_law;
use crate::control::{ControlError, StartAddress};

/// Steps of `1 + ε`, with another `ε` for every step, independent of all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jittered<N>(
    /// The law of `ε`.
    pub N,
);

impl<T: Float, N: Noise> Clock<T> for Jittered<N> {
    type Memory = [T; 0];
    type Beat = ();

    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        ensure_law::<T>("the rms of step times", self.0.law())
    }

    fn start(&self, _: StartAddress) -> [T; 0] {
        []
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        self.0.words()
    }

    #[inline(always)]
    fn ratio(&self, _: &mut [T; 0], (): (), word: &mut impl FnMut() -> u32) -> T {
        forward(self.0.draw(word))
    }
}
