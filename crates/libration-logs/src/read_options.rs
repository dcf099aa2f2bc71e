//! Options of reading.

use crate::signal::ClockChoice;
use crate::time_unit::TimeUnit;

/// How to read a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The column of time of a table. Default: a column with a name such as `t`, `time`, `timestamp`, `stamp` or `time_ns`; else the
    /// first column.
    pub time: Option<String>,
    /// The unit of the column of time. Default: that of the file or of the name, else by the size of the numbers.
    pub time_unit: Option<TimeUnit>,
    /// The clock of a bag.
    pub clock: ClockChoice,
}

impl ReadOptions {
    /// With this column of time.
    pub(crate) fn of_time(name: &str) -> Self {
        ReadOptions { time: Some(name.to_owned()), ..ReadOptions::default() }
    }
}
