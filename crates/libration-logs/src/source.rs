//! What a reader of one format offers.

use crate::column::Gap;
use crate::error::LogError;
use crate::signal::{ClockChoice, Series, SignalInfo, TopicInfo};

/// An opened file of some format.
pub(crate) trait Source: Send {
    /// The name of the format.
    fn format(&self) -> String;
    /// The signals, in the order of the file.
    fn signals(&self) -> Vec<SignalInfo>;
    /// The topics, in the order of the file.
    fn topics(&self) -> Vec<TopicInfo>;
    /// A signal over time.
    fn series(&self, name: &str, clock: ClockChoice) -> Result<Series, LogError>;
    /// The time stamps of a topic in file order, in s from the first stamp of the file.
    fn stamps(&self, topic: &str, clock: ClockChoice) -> Result<Vec<f64>, LogError>;
    /// The time stamps of a topic in file order, in ns from the zero of the clock itself; none for a message without the clock.
    fn exact_stamps(&self, topic: &str, clock: ClockChoice) -> Result<Vec<Option<i64>>, LogError>;
    /// Whether there are messages on topics.
    fn is_bag(&self) -> bool {
        false
    }
    /// The first line of a text without a finite number in the column of time.
    fn time_gap(&self) -> Option<&Gap> {
        None
    }
    /// Whether a signal is the column of time.
    fn is_time(&self, _name: &str) -> bool {
        false
    }
    /// The distance of neighbouring numbers of floating point at the stamps of a topic, in s; 0 of whole numbers.
    fn resolution(&self, _topic: &str) -> f64 {
        0.0
    }
    /// The name of the column of time.
    fn time_name(&self) -> Option<String> {
        None
    }
    /// Remarks about the file, such as a truncated end.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
    /// The notes that may change a result. With `keeps_seconds`, an assumed second is none, as for results in the unit of the file.
    fn warnings(&self, _keeps_seconds: bool) -> Vec<String> {
        self.notes()
    }
}
