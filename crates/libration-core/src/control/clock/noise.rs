//! Distributions of noise, each a separate type: a loop over lanes cannot branch.

use crate::Float;
use crate::control::Jitter;
use crate::random::{UNIT, normal, odd};

/// A law with mean zero.
pub trait Noise: Copy + Send + Sync {
    /// The distribution as a value, for the theory.
    fn law(&self) -> Jitter;

    /// Random words that a draw takes.
    fn words(&self) -> usize;

    /// A draw.
    fn draw<T: Float>(&self, word: &mut impl FnMut() -> u32) -> T;
}

/// Gaussian, with this standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian(pub f64);

/// Uniform about zero, with this standard deviation: not beyond `√3` of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniform(pub f64);

impl Noise for Gaussian {
    fn law(&self) -> Jitter {
        Jitter::Gaussian(self.0)
    }

    fn words(&self) -> usize {
        2
    }

    #[inline(always)]
    fn draw<T: Float>(&self, word: &mut impl FnMut() -> u32) -> T {
        T::from_f64(self.0) * T::from_f64(normal([word(), word()]).into())
    }
}

impl Noise for Uniform {
    fn law(&self) -> Jitter {
        Jitter::Uniform(self.0)
    }

    fn words(&self) -> usize {
        1
    }

    #[inline(always)]
    fn draw<T: Float>(&self, word: &mut impl FnMut() -> u32) -> T {
        // The unit is a factor of what does not change: an operation less.
        T::from_f64(self.0 * 3.0_f64.sqrt() * f64::from(UNIT)) * T::from_f64(odd(word()).into())
    }
}

/// A law that is chosen when the program runs: the same numbers, but no vectors.
impl Noise for Jitter {
    fn law(&self) -> Jitter {
        *self
    }

    fn words(&self) -> usize {
        match *self {
            Jitter::Gaussian(rms) => Gaussian(rms).words(),
            Jitter::Uniform(rms) => Uniform(rms).words(),
        }
    }

    #[inline(always)]
    fn draw<T: Float>(&self, word: &mut impl FnMut() -> u32) -> T {
        match *self {
            Jitter::Gaussian(rms) => Gaussian(rms).draw(word),
            Jitter::Uniform(rms) => Uniform(rms).draw(word),
        }
    }
}
