//! Distributions of step times.

use crate::random::LARGEST;

/// The law of step times `Δt(1 + ε)`, drawn independently for every step. No step is negative: where `ε` would be below −1
/// the step is of length zero, in theory as in a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Jitter {
    /// `ε` is Gaussian, with this standard deviation.
    Gaussian(f64),
    /// `ε` is uniform about zero, with this standard deviation.
    Uniform(f64),
}

impl Jitter {
    /// The standard deviation of `ε`.
    pub fn rms(self) -> f64 {
        match self {
            Jitter::Gaussian(rms) | Jitter::Uniform(rms) => rms,
        }
    }

    /// The same law with another standard deviation.
    pub fn with_rms(self, rms: f64) -> Self {
        match self {
            Jitter::Gaussian(_) => Jitter::Gaussian(rms),
            Jitter::Uniform(_) => Jitter::Uniform(rms),
        }
    }

    /// The largest `|ε|` that is drawn in a simulation, whose Gaussian numbers end at [`LARGEST`] deviations.
    pub fn largest(self) -> f64 {
        match self {
            Jitter::Gaussian(rms) => f64::from(LARGEST) * rms,
            Jitter::Uniform(rms) => 3.0_f64.sqrt() * rms,
        }
    }

    /// Whether there are steps of length zero: whether any `ε` below −1 is drawn in a simulation.
    pub fn clips(self) -> bool {
        self.largest() > 1.0
    }

    /// The largest standard deviation at which steps of this law are no shorter than 0: all of them of a uniform law,
    /// those within three deviations of a Gaussian one.
    pub fn largest_rms(self) -> f64 {
        match self {
            Jitter::Gaussian(_) => 1.0 / 3.0,
            Jitter::Uniform(_) => 1.0 / 3.0_f64.sqrt(),
        }
    }
}
