//! Options of reading.

use crate::error::LogError;
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
    /// Fails for a column or unit of time, which stamps of this format do not take.
    pub(crate) fn ensure_no_time(&self, format: &str) -> Result<(), LogError> {
        let option = match (&self.time, self.time_unit) {
            (Some(_), _) => "--time",
            (None, Some(_)) => "--time-unit",
            (None, None) => return Ok(()),
        };
        Err(LogError::Damaged(format!(
            "{option} is given, but the time stamps of the format {format} are in no column and have a unit; expected no {option}; help: --topic and --clock choose time stamps of a bag"
        )))
    }

    /// Fails for another clock than that of the column of time.
    pub(crate) fn ensure_log_clock(&self, format: &str) -> Result<(), LogError> {
        match self.clock {
            ClockChoice::Log => Ok(()),
            clock => Err(LogError::Damaged(format!(
                "--clock is {}, but the only clock of the format {format} is the column of time; help: choose a column with --time or --topic",
                clock.name()
            ))),
        }
    }

    /// With this column of time.
    pub(crate) fn of_time(name: &str) -> Self {
        ReadOptions { time: Some(name.to_owned()), ..ReadOptions::default() }
    }
}
