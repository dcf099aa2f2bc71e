//! Imperfections of the timing of a loop.

use libration_core::control::{Jitter, Latency};
use thiserror::Error;

/// All that may be wrong with the timing of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imperfections {
    /// The latency of the commands.
    pub latency: Latency,
    /// The law of step times, each drawn for itself.
    pub jitter: Jitter,
    /// The part by which all steps are longer than they should be.
    pub skew: f64,
    /// The probability that a command is lost, independently; the acting command then stays.
    pub loss: f64,
}

impl Imperfections {
    /// No imperfections.
    pub const NONE: Imperfections = Imperfections {
        latency: Latency::NONE,
        jitter: Jitter::Gaussian(0.0),
        skew: 0.0,
        loss: 0.0,
    };

    /// Whether all steps are the same.
    pub(super) fn repeat(&self) -> bool {
        self.jitter.rms() == 0.0 && self.loss == 0.0
    }
}

/// Error of the cost of a loop.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum CostError {
    /// A weight is invalid.
    #[error("the weight of the {of} is {weight}; it must be a number that is at least 0")]
    Weight {
        /// The weighted quantity.
        of: &'static str,
        /// The weight.
        weight: f64,
    },
    /// The probability of a loss is invalid.
    #[error("the probability that a command is lost is {0}; it must be at least 0 and below 1")]
    Loss(f64),
    /// Steps would not be above zero.
    #[error("the skew is {0}; it must be a number above −1")]
    Skew(f64),
    /// The matrix would be too large.
    #[error(
        "the latency is too many periods long: the state of the loop has {size} numbers, most of them commands in transit; the most is {MOST_RANDOM} \
         with jitter or losses, {MOST_RECORDED} with a record and losses, {MOST_REPEATED} without them"
    )]
    Size {
        /// State, controller and waiting commands.
        size: usize,
    },
    /// A step of a record is invalid.
    #[error(
        "a step of the record is {0} periods long; it must be finite and at least 0, and one of them above 0"
    )]
    Step(f64),
    /// Steps turn too far.
    #[error("steps turn by more than 2048 rad in a standard deviation of the jitter")]
    Turn,
}

/// Coordinates of a loop whose steps are drawn: a growth takes a second.
pub(super) const MOST_RANDOM: usize = 100;

/// Coordinates of a loop whose clock is replayed and whose commands may be lost: 300 second moments.
pub(super) const MOST_RECORDED: usize = 24;

/// Coordinates of a loop whose steps are all the same.
pub(super) const MOST_REPEATED: usize = 300;
