//! Options of logs with several topics and clocks.

use std::path::Path;

use clap::{Args, ValueEnum};
use libration_logs::{ClockChoice, ReadOptions, StampOptions, TimeUnit};

use crate::error::Failure;

/// The topic and the clock of the time stamps of a file.
#[derive(Args, Clone, Debug)]
pub(crate) struct TopicArgs {
    /// Topic of a log, or column of a table, that has the time stamps [default: the only topic, or the column of time]
    #[arg(long, value_name = "NAME")]
    pub(crate) topic: Option<String>,
    /// Clock of a log with several: that of the recorder, of the sender, or in the header of messages
    #[arg(long, value_name = "WHICH", default_value = "log")]
    pub(crate) clock: ClockName,
    /// Column of time of a table [default: a column named as one, else the first]
    #[arg(long, value_name = "COLUMN")]
    pub(crate) time: Option<String>,
    /// Unit of the column of time [default: of the file or the name, else by the size of the numbers]
    #[arg(long, value_name = "UNIT")]
    pub(crate) time_unit: Option<TimeUnitName>,
}

impl TopicArgs {
    /// Returns the choice of time stamps.
    pub(crate) fn options(&self) -> StampOptions {
        StampOptions { topic: self.topic.clone(), read: self.read_options() }
    }

    /// Fails for options of a log without the file of `flag`.
    pub(crate) fn ensure_file(&self, flag: &str, file: Option<&Path>) -> Result<(), Failure> {
        match (&self.words(None)[..], file) {
            ([option, value, ..], None) => Err(Failure::usage(format!(
                "{option} is `{value}` without a log; help: add {flag} FILE"
            ))),
            _ => Ok(()),
        }
    }

    /// Returns how to read the log.
    pub(crate) fn read_options(&self) -> ReadOptions {
        ReadOptions {
            time: self.time.clone(),
            time_unit: self.time_unit.map(TimeUnitName::unit),
            clock: self.clock.choice(),
        }
    }

    /// Returns the options and their values as words of a command line, without those that have their defaults; the topic is `topic`,
    /// if there is none.
    pub(crate) fn words(&self, topic: Option<&str>) -> Vec<String> {
        let clock = (self.clock != ClockName::Log).then(|| self.clock.choice().name().to_owned());
        let unit = self.time_unit.and_then(|unit| unit.to_possible_value());
        let options = [
            ("--topic", self.topic.clone().or_else(|| topic.map(str::to_owned))),
            ("--clock", clock),
            ("--time", self.time.clone()),
            ("--time-unit", unit.map(|unit| unit.get_name().to_owned())),
        ];
        let given = options.into_iter().filter_map(|(name, value)| Some([name.to_owned(), value?]));
        given.flatten().collect()
    }
}

/// The value of `--clock`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ClockName {
    /// The time at which the recorder received a message.
    #[default]
    Log,
    /// The time at which the sender published it.
    Publish,
    /// The time in its header.
    Header,
}

impl ClockName {
    /// Returns the clock.
    pub(crate) fn choice(self) -> ClockChoice {
        match self {
            ClockName::Log => ClockChoice::Log,
            ClockName::Publish => ClockChoice::Publish,
            ClockName::Header => ClockChoice::Header,
        }
    }
}

/// The value of `--time-unit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TimeUnitName {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
}

impl TimeUnitName {
    /// Returns the unit.
    pub(crate) fn unit(self) -> TimeUnit {
        match self {
            TimeUnitName::S => TimeUnit::S,
            TimeUnitName::Ms => TimeUnit::Ms,
            TimeUnitName::Us => TimeUnit::Us,
            TimeUnitName::Ns => TimeUnit::Ns,
        }
    }
}
