//! Clocks whose rate is a random walk.

use super::{Clock, Gaussian, Noise, forward};
use crate::Float;
use crate::control::error::ensure_not_negative;
use crate::control::{ControlError, StartAddress};

/// Steps of `1 + ε`, where `ε` begins at zero and changes by an independent Gaussian number in every step.
///
/// Random-walk frequency noise: D. W. Allan, *Statistics of atomic frequency standards*, Proceedings of the IEEE
/// 54, 1966.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomWalk {
    /// The standard deviation of a change; after `n` steps that of `ε` is `√n` times as large.
    pub rms: f64,
}

impl<T: Float> Clock<T> for RandomWalk {
    type Memory = [T; 1];
    type Beat = ();

    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        ensure_not_negative::<T>("the rms of changes of the rate", self.rms)
    }

    fn start(&self, _: StartAddress) -> [T; 1] {
        [T::zero()]
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        2
    }

    #[inline(always)]
    fn ratio(&self, [epsilon]: &mut [T; 1], (): (), word: &mut impl FnMut() -> u32) -> T {
        let now = *epsilon;
        *epsilon = now + Gaussian(self.rms).draw::<T>(word);
        forward(now)
    }
}
