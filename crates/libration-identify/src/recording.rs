//! A log of a command and of the response to it.

use thiserror::Error;

/// Commands and responses with their times, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Times of the commands in s, not decreasing.
    pub command_times: Vec<f64>,
    /// The commands.
    pub commands: Vec<f64>,
    /// Times of the responses in s, not decreasing.
    pub response_times: Vec<f64>,
    /// The responses.
    pub responses: Vec<f64>,
}

/// Fewest responses of a recording.
pub const FEWEST_RESPONSES: usize = 30;

/// Error of a recording.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RecordingError {
    /// Times and values differ in number.
    #[error("{times} times for {values} values of the {signal}; expected one time for each value")]
    Lengths {
        /// `command` or `response`.
        signal: &'static str,
        /// The number of times.
        times: usize,
        /// The number of values.
        values: usize,
    },
    /// A number is infinite or NaN.
    #[error("{what} {index} of the {signal} is {value}; expected a finite number")]
    NotFinite {
        /// `command` or `response`.
        signal: &'static str,
        /// `time` or `value`.
        what: &'static str,
        /// The index, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A time is smaller than the one before it.
    #[error(
        "time {index} of the {signal} is {after} s, after {before} s; expected times that do not decrease"
    )]
    Backwards {
        /// `command` or `response`.
        signal: &'static str,
        /// The index, from 0.
        index: usize,
        /// The time before.
        before: f64,
        /// The time.
        after: f64,
    },
    /// The command never changes.
    #[error(
        "the command is {0} throughout; expected a command that changes, since nothing else shows a latency"
    )]
    ConstantCommand(f64),
    /// The response never changes.
    #[error("the response is {0} throughout; expected a response that changes")]
    ConstantResponse(f64),
    /// There are too few responses while commands are known.
    #[error(
        "{count} responses follow the first command; expected at least {FEWEST_RESPONSES}, spread over time"
    )]
    TooFew {
        /// Their number.
        count: usize,
    },
}

impl Recording {
    /// A recording of separate time stamps for commands and responses, in s. Responses before the first command are left out.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn new(
        command_times: &[f64],
        commands: &[f64],
        response_times: &[f64],
        responses: &[f64],
    ) -> Result<Self, RecordingError> {
        check("command", command_times, commands)?;
        check("response", response_times, responses)?;
        let first = command_times.first().copied().unwrap_or(f64::INFINITY);
        let skipped = response_times.iter().take_while(|&&time| time < first).count();
        let kept = response_times.len() - skipped;
        let spread = match &response_times[skipped..] {
            [start, .., end] => end - start,
            _ => 0.0,
        };
        if kept < FEWEST_RESPONSES || !(spread > 0.0) {
            return Err(RecordingError::TooFew { count: kept });
        }
        if commands.iter().all(|&command| command == commands[0]) {
            return Err(RecordingError::ConstantCommand(commands[0]));
        }
        if responses.iter().all(|&response| response == responses[0]) {
            return Err(RecordingError::ConstantResponse(responses[0]));
        }
        // Times from the first command on, so that a clock that counts from 1970 costs no digits of a latency.
        let from_first = |times: &[f64]| times.iter().map(|time| time - first).collect();
        Ok(Recording {
            command_times: from_first(command_times),
            commands: commands.to_vec(),
            response_times: from_first(&response_times[skipped..]),
            responses: responses[skipped..].to_vec(),
        })
    }

    /// Median interval of the responses, in s; of those above zero.
    pub fn interval(&self) -> f64 {
        let mut intervals: Vec<f64> = self
            .response_times
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|&interval| interval > 0.0)
            .collect();
        intervals.sort_by(f64::total_cmp);
        intervals[intervals.len() / 2]
    }

    /// Time from the first to the last response, in s.
    pub fn span(&self) -> f64 {
        self.response_times[self.response_times.len() - 1] - self.response_times[0]
    }

    /// The same commands at the same times with other responses.
    #[must_use]
    pub fn with_responses(&self, responses: Vec<f64>) -> Self {
        Recording { responses, ..self.clone() }
    }
}

fn check(signal: &'static str, times: &[f64], values: &[f64]) -> Result<(), RecordingError> {
    if times.len() != values.len() {
        let (times, values) = (times.len(), values.len());
        return Err(RecordingError::Lengths { signal, times, values });
    }
    for (what, numbers) in [("time", times), ("value", values)] {
        if let Some(index) = numbers.iter().position(|number| !number.is_finite()) {
            return Err(RecordingError::NotFinite { signal, what, index, value: numbers[index] });
        }
    }
    match times.windows(2).position(|pair| pair[1] < pair[0]) {
        None => Ok(()),
        Some(i) => Err(RecordingError::Backwards {
            signal,
            index: i + 1,
            before: times[i],
            after: times[i + 1],
        }),
    }
}
