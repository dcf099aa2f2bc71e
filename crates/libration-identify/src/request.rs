//! What is to be identified.

use std::ops::RangeInclusive;

use libration_work::Interrupted;
use thiserror::Error;

use crate::hold::Hold;
use crate::noise::NoiseKind;
use crate::recording::{FEWEST_RESPONSES, Recording, RecordingError};
use crate::response::ResponseKind;
use crate::start::{Start, likely_start};

/// What is to be identified, and what is known.
#[derive(Clone, Debug)]
pub struct Request {
    /// The forms of the response to choose from.
    pub responses: Vec<ResponseKind>,
    /// The kinds of noise to choose from.
    pub noises: Vec<NoiseKind>,
    /// What a receiver makes of commands between their times. With both, a receiver that moves on lines is reported but not chosen.
    pub holds: Vec<Hold>,
    /// The dead time in s, if it is known.
    pub dead_time: Option<f64>,
    /// The lag in s, if it is known.
    pub lag: Option<f64>,
    /// The gain, if it is known.
    pub gain: Option<f64>,
    /// The largest dead time in s. Default: an eighth of the recording, at most 1 s or 50 intervals of the responses.
    pub largest_dead_time: Option<f64>,
    /// What is assumed before the first response. Default: [`Start::Rest`] if the recording begins with a long hold of the command, or if
    /// nearly all of a few changes would be lost with the responses up to the largest dead time, unless the responses contradict it; else
    /// [`Start::Unknown`].
    pub start: Option<Start>,
    /// The number of evaluations of the likelihood that the search of a model may take. Default: 1000 to 20,000, fewer for long recordings.
    pub budget: Option<usize>,
    /// Whether losses, two delays and jitter of arrivals are looked for.
    pub arrivals: bool,
    /// Whether the likelihood over dead time and lag, and other commands, are looked at.
    pub details: bool,
    /// The number of simulated recordings that check the intervals; 0 for none.
    pub bootstrap: usize,
    /// Seed of the simulated recordings.
    pub seed: u64,
}

impl Default for Request {
    fn default() -> Self {
        Request {
            responses: ResponseKind::SIMPLE.to_vec(),
            noises: NoiseKind::ALL.to_vec(),
            holds: vec![Hold::Zero, Hold::Linear],
            dead_time: None,
            lag: None,
            gain: None,
            largest_dead_time: None,
            start: None,
            budget: None,
            arrivals: true,
            details: true,
            bootstrap: 100,
            seed: 0,
        }
    }
}

/// Most responses of a recording.
pub const MOST_RESPONSES: usize = 1_000_000;
/// Most simulated recordings of a bootstrap.
pub const MOST_BOOTSTRAPS: usize = 10_000;

/// Evaluations that the search of a model may take.
const BUDGETS: RangeInclusive<usize> = 100..=1_000_000_000;

/// Error of an identification.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IdentifyError {
    /// The recording is invalid.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A number is invalid.
    #[error("{name} is {value}; expected {expected}")]
    Value {
        /// The name.
        name: &'static str,
        /// The value.
        value: f64,
        /// What is allowed.
        expected: String,
    },
    /// Too few responses are left behind the largest dead time.
    #[error(
        "{count} responses follow the first command by more than the largest dead time of {largest} s; expected at least {FEWEST_RESPONSES}; help: record for longer, or lower the largest dead time"
    )]
    TooFewBehind {
        /// Their number.
        count: usize,
        /// The largest dead time in s.
        largest: f64,
    },
    /// There are too many responses.
    #[error("{0} responses; expected at most {MOST_RESPONSES}; help: use a part of the recording")]
    TooMany(usize),
    /// The command does not change where responses depend on it.
    #[error(
        "the command changes only after the last response that could show it; expected changes within the first {0} s"
    )]
    NoExcitation(f64),
    /// No model has a finite likelihood.
    #[error("no model fits: the responses exceed the range of numbers")]
    NoFit,
    /// No search ended.
    #[error(
        "no search of a model ended within {0} evaluations of the likelihood; help: raise the budget, or name the model"
    )]
    Budget(u64),
    /// The user stopped the work.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl Request {
    /// The largest dead time for a recording, in s, and what is assumed before its first response, once everything is checked.
    pub(crate) fn check(&self, recording: &Recording) -> Result<(f64, Start), IdentifyError> {
        let invalid = |name, value, expected: &str| {
            Err(IdentifyError::Value { name, value, expected: expected.to_owned() })
        };
        let non_negative = "a number of at least 0 s";
        for (name, value) in [("dead time", self.dead_time), ("lag", self.lag)] {
            if let Some(value) = value.filter(|value| !(*value >= 0.0 && value.is_finite())) {
                return invalid(name, value, non_negative);
            }
        }
        if let Some(gain) = self.gain.filter(|gain| !gain.is_finite() || *gain == 0.0) {
            return invalid("gain", gain, "a number other than 0");
        }
        if self.bootstrap > MOST_BOOTSTRAPS {
            let expected = format!("at most {MOST_BOOTSTRAPS} simulated recordings");
            return invalid("bootstrap", self.bootstrap as f64, &expected);
        }
        if let Some(budget) = self.budget.filter(|budget| !BUDGETS.contains(budget)) {
            let expected = format!("{} to {} evaluations", BUDGETS.start(), BUDGETS.end());
            return invalid("budget", budget as f64, &expected);
        }
        if recording.responses.len() > MOST_RESPONSES {
            return Err(IdentifyError::TooMany(recording.responses.len()));
        }
        let span = recording.span();
        let largest = match self.largest_dead_time {
            None => {
                let usual = (span / 8.0).min(1.0_f64.max(50.0 * recording.interval()));
                // A known dead time needs no room beyond it.
                self.dead_time.map_or(usual, |known| known.max(recording.interval()))
            }
            Some(largest) if largest > 0.0 && largest.is_finite() => largest,
            Some(largest) => return invalid("largest dead time", largest, "a number above 0 s"),
        };
        if let Some(known) = self.dead_time.filter(|&known| known > largest) {
            let expected = format!("at most the largest dead time, {largest} s");
            return invalid("dead time", known, &expected);
        }
        let start = self.start.unwrap_or_else(|| likely_start(recording, largest));
        let behind = recording.response_times.iter().filter(|&&time| time >= largest).count();
        if behind < FEWEST_RESPONSES && start == Start::Unknown {
            return Err(IdentifyError::TooFewBehind { count: behind, largest });
        }
        let last = recording.response_times[recording.response_times.len() - 1];
        let changes = recording.commands.windows(2).zip(&recording.command_times[1..]);
        let mut changes = changes.filter(|(pair, _)| pair[0] != pair[1]);
        if !changes.any(|(_, &time)| time < last) {
            return Err(IdentifyError::NoExcitation(last));
        }
        Ok((largest, start))
    }
}
