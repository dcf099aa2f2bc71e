//! Errors of loops around linear plants.

use libration_core::control::Latency;
use thiserror::Error;

use crate::loop_timing::{MOST_RANDOM, MOST_REPEATED};

/// Error of a loop around a linear plant.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LinearLoopError {
    /// The controller does not fit the plant.
    #[error("the controller has {given} {of}; expected {expected}, the {side} of the plant")]
    Channels {
        /// `commands` or `measurements`.
        of: &'static str,
        /// Their number.
        given: usize,
        /// The expected number.
        expected: usize,
        /// `inputs` or `outputs`.
        side: &'static str,
    },
    /// A matrix of the controller or the cost has the wrong shape, or entries that are not finite.
    #[error("`{0}` has the wrong shape, or an entry that is not finite")]
    Matrix(&'static str),
    /// The period is invalid.
    #[error("the period is {0} s; expected a finite number above 0")]
    Period(f64),
    /// The plant is sampled with another period.
    #[error(
        "the period is {period} s, but the plant is sampled every {sampled} s; expected the same"
    )]
    Sampled {
        /// The period of the loop.
        period: f64,
        /// The sampling period of the plant.
        sampled: f64,
    },
    /// The plant is sampled, and time between samples is not defined.
    #[error(
        "the plant is sampled: {0} is not defined between its samples; help: give the plant in continuous time"
    )]
    BetweenSamples(&'static str),
    /// There is not one latency for each channel.
    #[error("{given} latencies of {count} {of}; expected one for each")]
    Latencies {
        /// `inputs` or `outputs`.
        of: &'static str,
        /// The number of latencies.
        given: usize,
        /// The number of channels.
        count: usize,
    },
    /// The channels that are late together are invalid.
    #[error(
        "the late {of} are {given:?}; expected at least one, each once, with numbers below {count}"
    )]
    LateChannels {
        /// `inputs` or `outputs`.
        of: &'static str,
        /// Their numbers.
        given: Vec<usize>,
        /// The number of channels.
        count: usize,
    },
    /// A latency is invalid.
    #[error(
        "the latency is {periods} periods of the loop; it must be at least 0 and at most {} periods",
        Latency::MOST_STEPS
    )]
    Latency {
        /// In periods.
        periods: f64,
    },
    /// The probability of a loss is invalid.
    #[error("the probability that commands are lost is {0}; expected at least 0 and below 1")]
    Loss(f64),
    /// The probability of an overrun is invalid.
    #[error("the probability that a job overruns is {0}; expected at least 0 and below 1")]
    Overruns(f64),
    /// Commands are lost besides random overruns.
    #[error("commands are lost, and jobs overrun at random; expected one of the two")]
    LossAndOverruns,
    /// Periods would not be above zero.
    #[error("the skew is {0}; expected a number above −1")]
    Skew(f64),
    /// The loop is too large.
    #[error(
        "the loop has {size} states with all commands and measurements in transit; expected at most {most}{}",
        in_words(*most)
    )]
    Size {
        /// The number of states.
        size: usize,
        /// The most with this timing.
        most: usize,
    },
    /// A period of a record is invalid.
    #[error(
        "a period of the record is {0} mean periods long; expected finite numbers of at least 0, and one of them above 0"
    )]
    Record(f64),
    /// A statement that requires one controller for all periods.
    #[error(
        "{what} require the same controller in all periods; this loop repeats a schedule of {periods} periods"
    )]
    Schedule {
        /// What requires it.
        what: &'static str,
        /// The periods of the schedule.
        periods: usize,
    },
    /// The periods of a loop are beyond the range of floats.
    #[error("the periods of the loop are beyond the range of floats")]
    Range,
    /// A search for latencies ends without an answer.
    #[error(
        "the search for stable latencies ended after {responses} parts of a period: rounding hides where the loop has unit gain"
    )]
    Search {
        /// The responses that were computed.
        responses: u64,
    },
    /// The plant moves too far in a period.
    #[error("the plant turns by more than 2048 rad in a standard deviation of the jitter")]
    Turn,
}

/// The most states of loops of other timings.
fn in_words(most: usize) -> String {
    match most {
        MOST_RANDOM => format!(" with jitter, losses or overruns, {MOST_REPEATED} without"),
        _ => String::new(),
    }
}
