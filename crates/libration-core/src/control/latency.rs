//! The latency of a command.

/// A latency of the command: whole steps and a fraction of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latency {
    steps: u64,
    /// At least 0, below 1.
    part: f64,
}

impl Latency {
    /// The most whole steps of which the spectral radius is found.
    pub const MOST_STEPS: u64 = 4096;

    /// No latency.
    pub const NONE: Latency = Latency { steps: 0, part: 0.0 };

    /// A latency in steps, if it is a number that is at least 0 and not too large.
    pub fn of_steps(steps: f64) -> Option<Self> {
        let fits = (0.0..=Self::MOST_STEPS as f64).contains(&steps);
        fits.then(|| Latency { steps: steps.trunc() as u64, part: steps.fract() })
    }

    /// A latency in seconds, of a loop in steps of `dt` seconds: 0.07 s are seven steps of 0.01 s, though their quotient is not
    /// seven in floats.
    pub fn of_seconds(seconds: f64, dt: f64) -> Option<Self> {
        let quotient = seconds / dt;
        let nearest = quotient.round();
        // Three roundings, of both decimals and of their quotient, are less than 2 ε.
        let whole = (quotient - nearest).abs() <= 4.0 * f64::EPSILON * nearest;
        Self::of_steps(if whole { nearest } else { quotient })
    }

    /// In steps.
    #[inline]
    pub fn steps(self) -> f64 {
        self.steps as f64 + self.part
    }

    /// The whole steps.
    #[inline]
    pub fn whole(self) -> u64 {
        self.steps
    }

    /// The part of another step.
    #[inline]
    pub fn part(self) -> f64 {
        self.part
    }
}
