//! Logs of any format.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::bag::Bag;
use crate::error::LogError;
use crate::mcap::Mcap;
use crate::source::Source;
use crate::{delimited_text, numpy_file, parquet_file};

/// A log: an opened file, whose format its first bytes determine.
pub struct Log {
    source: Box<dyn Source>,
    clock: ClockChoice,
}

/// How to read a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The column of time of a table. Default: a column with a name such as `t`, `time`, `timestamp`, `stamp` or `time_ns`; else the
    /// first column.
    pub time: Option<String>,
    /// The clock of a bag.
    pub clock: ClockChoice,
}

/// Which of the clocks of a bag gives the time of a message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ClockChoice {
    /// The time at which the recorder received the message.
    #[default]
    Log,
    /// The time at which the sender published it.
    Publish,
    /// The time in the header of the message.
    Header,
}

impl ClockChoice {
    /// All clocks.
    pub const ALL: [ClockChoice; 3] = [ClockChoice::Log, ClockChoice::Publish, ClockChoice::Header];

    /// The name of the clock.
    pub fn name(self) -> &'static str {
        match self {
            ClockChoice::Log => "log",
            ClockChoice::Publish => "publish",
            ClockChoice::Header => "header",
        }
    }
}

/// A signal of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalInfo {
    /// The name: a column, or `/topic.field`, `/topic.field.part`, `/topic.field[3]`.
    pub name: String,
    /// The number of values.
    pub count: usize,
    /// The unit, if the file has one.
    pub unit: Option<String>,
}

/// A topic of a log: messages of one kind, or a column of time stamps.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicInfo {
    /// The name.
    pub name: String,
    /// The type of its messages.
    pub message_type: String,
    /// The number of messages.
    pub count: usize,
    /// The clocks that its messages have.
    pub clocks: Vec<ClockChoice>,
}

/// A signal over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// The times in s from the first stamp of the file, in file order.
    pub time: Vec<f64>,
    /// As many values.
    pub values: Vec<f64>,
}

/// Bytes that determine the format.
const PREFIX: u64 = 4096;

impl Log {
    /// Opens a file.
    ///
    /// # Errors
    /// If the file cannot be read, has an unknown format or is damaged from its beginning on, or if it has no such column of time.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Log, LogError> {
        let mut prefix = Vec::new();
        let file = File::open(path)?;
        if file.metadata()?.is_dir() {
            return Err(LogError::Damaged("it is a directory; expected a file".to_owned()));
        }
        file.take(PREFIX).read_to_end(&mut prefix)?;
        let time = options.time.as_deref();
        let source: Box<dyn Source> = match prefix.as_slice() {
            [b'P', b'A', b'R', b'1', ..] => Box::new(parquet_file::open(path, time)?),
            [0x93, b'N', b'U', b'M', b'P', b'Y', ..] | [b'P', b'K', 3 | 5, ..] => {
                Box::new(numpy_file::open(path, time)?)
            }
            [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n', ..] => {
                Box::new(Bag::open(Mcap::new(path))?)
            }
            bytes if delimited_text::is_text(bytes) => Box::new(delimited_text::open(path, time)?),
            _ => return Err(LogError::UnknownFormat { expected: FORMATS }),
        };
        Ok(Log { source, clock: options.clock })
    }

    /// The name of the format.
    pub fn format(&self) -> String {
        self.source.format()
    }

    /// The signals, in the order of the file.
    pub fn signals(&self) -> Vec<SignalInfo> {
        self.source.signals()
    }

    /// A signal over time. Rows without a value are left out.
    ///
    /// # Errors
    /// If there is no such signal, with the nearest names; or if the file cannot be read.
    pub fn series(&self, name: &str) -> Result<Series, LogError> {
        self.source.series(name, self.clock)
    }

    /// The topics, in the order of the file.
    pub fn topics(&self) -> Vec<TopicInfo> {
        self.source.topics()
    }

    /// The time stamps of a topic in s from the first stamp of the file, in file order: they may go back.
    ///
    /// # Errors
    /// If there is no such topic, with the nearest names; if its messages lack the chosen clock; or if the file cannot be read.
    pub fn stamps(&self, topic: &str) -> Result<Vec<f64>, LogError> {
        self.source.stamps(topic, self.clock)
    }

    /// As [`Log::stamps`], by another clock than that of the options. The stamps have the same zero, unless a clock counts from
    /// another epoch: then its first stamp is zero.
    ///
    /// # Errors
    /// As [`Log::stamps`].
    pub fn stamps_of(&self, topic: &str, clock: ClockChoice) -> Result<Vec<f64>, LogError> {
        self.source.stamps(topic, clock)
    }

    /// The time stamps of a topic in ns from the zero of the clock itself, in file order; none for a message without the clock.
    ///
    /// # Errors
    /// As [`Log::stamps`].
    pub fn exact_stamps(
        &self,
        topic: &str,
        clock: ClockChoice,
    ) -> Result<Vec<Option<i64>>, LogError> {
        self.source.exact_stamps(topic, clock)
    }

    /// Remarks about the file, such as a truncated end.
    pub fn notes(&self) -> Vec<String> {
        self.source.notes()
    }
}

/// What [`Log::open`] reads.
const FORMATS: &str = "MCAP, CSV or other text, Parquet, or NumPy (.npy, .npz)";
