//! The clock of a topic.

use serde::Serialize;

use super::{Drift, LawFit, Statistics};
use crate::{ClockChoice, Log, LogError};

/// What the time stamps of a topic say about its clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicClock {
    /// The topic.
    pub topic: String,
    /// The type of its messages.
    pub message_type: String,
    /// The clock.
    pub clock: &'static str,
    /// The number of messages.
    pub messages: usize,
    /// The number of messages without this clock.
    pub without_clock: usize,
    /// The number of stamps before the preceding one in the file.
    pub backward: usize,
    /// The largest step back in s.
    pub largest_step_back: f64,
    /// Messages per second.
    pub rate: f64,
    /// Statistics of the intervals between the sorted stamps.
    pub statistics: Statistics,
    /// The law of the intervals.
    pub law: LawFit,
    /// The drift of the log clock against the header clock.
    pub log_against_header: Option<Drift>,
}

impl TopicClock {
    /// The clock of a topic.
    ///
    /// # Errors
    /// If there is no such topic or clock, or fewer than two stamps.
    pub fn of(log: &Log, topic: &str, clock: ClockChoice) -> Result<Self, LogError> {
        let exact = log.exact_stamps(topic, clock)?;
        let mut stamps: Vec<i64> = exact.iter().flatten().copied().collect();
        let back = |pair: &[i64]| (i128::from(pair[0]) - i128::from(pair[1])) as f64 / 1e9;
        let largest_step_back = stamps.windows(2).map(back).fold(0.0, f64::max);
        let backward = stamps.windows(2).filter(|pair| pair[1] < pair[0]).count();
        stamps.sort_unstable();
        let (&[first, ..], true) = (stamps.as_slice(), stamps.len() >= 2) else {
            let count = stamps.len();
            return Err(LogError::Damaged(format!(
                "the number of time stamps of `{topic}` is {count}; expected at least 2"
            )));
        };
        let since = |&x: &i64| (i128::from(x) - i128::from(first)) as f64 / 1e9;
        let seconds: Vec<f64> = stamps.iter().map(since).collect();
        let intervals: Vec<f64> = stamps
            .windows(2)
            .map(|pair| (i128::from(pair[1]) - i128::from(pair[0])) as f64 / 1e9)
            .collect();
        let statistics = Statistics::of(&seconds, None);
        if statistics.mean <= 0.0 {
            return Err(LogError::Damaged(format!("all time stamps of `{topic}` are equal")));
        }
        let fits = |name: &str| name == topic || name.strip_prefix('/') == Some(topic);
        let info = log.topics().into_iter().find(|info| fits(&info.name));
        let has_header = info.as_ref().is_some_and(|i| i.clocks.contains(&ClockChoice::Header));
        let log_against_header = match has_header {
            true => Drift::between(
                &log.exact_stamps(topic, ClockChoice::Header)?,
                &log.exact_stamps(topic, ClockChoice::Log)?,
            ),
            false => None,
        };
        Ok(TopicClock {
            topic: topic.to_owned(),
            message_type: info.map_or_else(String::new, |info| info.message_type),
            clock: clock.name(),
            messages: exact.len(),
            without_clock: exact.iter().filter(|stamp| stamp.is_none()).count(),
            backward,
            largest_step_back,
            rate: 1.0 / statistics.mean,
            law: LawFit::of(&intervals),
            statistics,
            log_against_header,
        })
    }
}
