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
        "the command is {0} throughout; expected a command that changes, since nothing else shows a latency; help: if another command acted before the recording, state it"
    )]
    ConstantCommand(f64),
    /// The response never changes.
    #[error("the response is {0} throughout; expected a response that changes")]
    ConstantResponse(f64),
    /// Values are too large or too small to be squared.
    #[error(
        "values of the {signal} differ by {spread:e} at most, from {offset:e} in size; expected differences from 1e-100 to 1e100 and at least 1e-12 of the size"
    )]
    Scale {
        /// `command` or `response`.
        signal: &'static str,
        /// The largest difference of two values.
        spread: f64,
        /// The largest absolute value.
        offset: f64,
    },
    /// Times are too close or too far apart.
    #[error(
        "the responses have a median interval of {interval:e} s and last {span:e} s; expected intervals from 1e-9 s to 1e7 s, and at most 1e9 of them"
    )]
    Interval {
        /// The median interval in s.
        interval: f64,
        /// From the first to the last response in s.
        span: f64,
    },
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
        if kept < FEWEST_RESPONSES || spread <= 0.0 {
            return Err(RecordingError::TooFew { count: kept });
        }
        if commands.iter().all(|&command| command == commands[0]) {
            return Err(RecordingError::ConstantCommand(commands[0]));
        }
        if responses.iter().all(|&response| response == responses[0]) {
            return Err(RecordingError::ConstantResponse(responses[0]));
        }
        check_scale("command", commands)?;
        check_scale("response", &responses[skipped..])?;
        // Times from the first command on, so that a clock that counts from 1970 costs no digits of a latency.
        let from_first =
            |times: &[f64]| -> Vec<f64> { times.iter().map(|time| time - first).collect() };
        let (response_times, responses) =
            merged(&from_first(&response_times[skipped..]), &responses[skipped..]);
        if response_times.len() < FEWEST_RESPONSES {
            return Err(RecordingError::TooFew { count: response_times.len() });
        }
        let recording = Recording {
            command_times: from_first(command_times),
            commands: commands.to_vec(),
            response_times,
            responses,
        };
        let (interval, span) = (recording.interval(), recording.span());
        let last = recording.command_times[recording.command_times.len() - 1];
        match (1e-9..1e7).contains(&interval) && span.max(last) <= 1e9 * interval {
            true => Ok(recording),
            false => Err(RecordingError::Interval { interval, span: span.max(last) }),
        }
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

    /// How many commands seem to be missing: intervals of several periods where nearly all intervals are one.
    pub fn missing_commands(&self) -> usize {
        let intervals: Vec<f64> =
            self.command_times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut sorted = intervals.clone();
        sorted.sort_by(f64::total_cmp);
        let Some(&median) = sorted.get(sorted.len() / 2).filter(|median| **median > 0.0) else {
            return 0;
        };
        let is_regular = |interval: &&f64| (**interval / median - 1.0).abs() < 0.2;
        let is_gap = |interval: &&f64| **interval > 1.5 * median;
        let gaps = intervals.iter().filter(is_gap).count();
        match intervals.iter().filter(is_regular).count() + gaps > intervals.len() * 9 / 10 {
            true => gaps,
            false => 0,
        }
    }

    /// The part of `count` responses from the `first` on, with the commands that act in it after dead times up to `longest`, in s.
    #[must_use]
    pub(crate) fn excerpt(&self, first: usize, count: usize, longest: f64) -> Self {
        let end = self.responses.len().min(first + count);
        let start = self.response_times[first] - longest;
        // The last command before the part acts at its start.
        let known = self.command_times.partition_point(|&time| time <= start).saturating_sub(1);
        let zero = self.command_times[known];
        let shifted = |times: &[f64]| times.iter().map(|time| time - zero).collect();
        Recording {
            command_times: shifted(&self.command_times[known..]),
            commands: self.commands[known..].to_vec(),
            response_times: shifted(&self.response_times[first..end]),
            responses: self.responses[first..end].to_vec(),
        }
    }

    /// The recording behind a command that acted before its first one.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn behind(
        before: f64,
        command_times: &[f64],
        commands: &[f64],
        response_times: &[f64],
        responses: &[f64],
    ) -> Result<Self, RecordingError> {
        check("command", command_times, commands)?;
        check("response", response_times, responses)?;
        let period = |times: &[f64]| {
            let mut periods: Vec<f64> =
                times.windows(2).map(|pair| pair[1] - pair[0]).filter(|&x| x > 0.0).collect();
            periods.sort_by(f64::total_cmp);
            periods.get(periods.len() / 2).copied()
        };
        // A period before the first, where a gap is none.
        let period = period(command_times).or_else(|| period(response_times)).unwrap_or(0.0);
        let first = command_times.first().map(|first| first - period);
        let times: Vec<f64> = first.into_iter().chain(command_times.iter().copied()).collect();
        let values: Vec<f64> =
            first.map(|_| before).into_iter().chain(commands.iter().copied()).collect();
        Recording::new(&times, &values, response_times, responses)
    }

    /// The same commands at the same times with other responses.
    #[must_use]
    pub fn with_responses(&self, responses: Vec<f64>) -> Self {
        Recording { responses, ..self.clone() }
    }
}

/// Responses of one time as their mean: two errors at the same time are no two errors of a process in time.
fn merged(times: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut rows: Vec<(f64, f64, f64)> = Vec::with_capacity(times.len());
    for (&time, &value) in times.iter().zip(values) {
        match rows.last_mut().filter(|row| row.0 == time) {
            Some((_, mean, count)) => {
                *count += 1.0;
                *mean += (value - *mean) / *count;
            }
            None => rows.push((time, value, 1.0)),
        }
    }
    rows.into_iter().map(|(time, mean, _)| (time, mean)).unzip()
}

/// Fails for values whose squares a float cannot hold, or whose differences are their rounding.
fn check_scale(signal: &'static str, values: &[f64]) -> Result<(), RecordingError> {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    let (spread, offset) = (high - low, high.abs().max(low.abs()));
    match (1e-100..1e100).contains(&spread) && spread >= 1e-12 * offset {
        true => Ok(()),
        false => Err(RecordingError::Scale { signal, spread, offset }),
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
