//! Options of logs with several topics and clocks.

use clap::{Args, ValueEnum};
use libration_logs::{ClockChoice, StampOptions, TimeUnit};

/// The topic and the clock of the time stamps of a file.
#[derive(Args, Clone, Debug)]
pub(crate) struct TopicArgs {
    /// Topic of a log, or column of a table, that has the time stamps [default: the only topic, or the column of time]
    #[arg(long, value_name = "NAME")]
    pub(crate) topic: Option<String>,
    /// Clock of a log with several: that of the recorder, of the sender, or in the header of messages
    #[arg(long, value_name = "WHICH", default_value = "log")]
    pub(crate) clock: ClockName,
}

impl TopicArgs {
    /// Returns the choice of time stamps.
    pub(crate) fn options(&self) -> StampOptions {
        StampOptions { topic: self.topic.clone(), clock: self.clock.choice() }
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
