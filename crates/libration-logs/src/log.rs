//! Logs of any format.

use std::path::Path;

use crate::bag::Bag;
use crate::bag_directory::{file_of_bag, is_metadata};
use crate::column::Gap;
use crate::cyclictest::{self, Output};
use crate::error::LogError;
use crate::input::Input;
use crate::mcap::Mcap;
use crate::read_options::ReadOptions;
use crate::rosbag::Rosbag;
use crate::rosbag2::{self, Rosbag2};
use crate::signal::{ClockChoice, Series, SignalInfo, TopicInfo};
use crate::source::Source;
use crate::text_encoding::text_prefix;
use crate::ulog::Ulog;
use crate::{delimited_text, numpy_file, parquet_file, rosbag, ulog};

/// A log: an opened file, whose format its first bytes determine.
pub struct Log {
    source: Box<dyn Source>,
    clock: ClockChoice,
}

/// Bytes that determine the format.
const PREFIX: u64 = 4096;

impl Log {
    /// Opens a file, or the only file of a directory that `ros2 bag record` wrote.
    ///
    /// # Errors
    /// If the file cannot be read, has an unknown format or is damaged from its beginning on, or if it has no such clock or column of
    /// time; or if a directory has several bags or none.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Log, LogError> {
        match path.is_dir() {
            true => Self::read(Input::of(&file_of_bag(path)?)?, options),
            false => Self::read(Input::of(path)?, options),
        }
    }

    /// Opens a file that is in memory.
    ///
    /// # Errors
    /// As [`Log::open`].
    pub fn from_bytes(bytes: Vec<u8>, options: &ReadOptions) -> Result<Log, LogError> {
        Self::read(Input::Memory(bytes.into()), options)
    }

    /// Opens an input.
    pub(crate) fn read(input: Input, options: &ReadOptions) -> Result<Log, LogError> {
        let prefix = input.prefix(PREFIX)?;
        let source: Box<dyn Source> = match prefix.as_slice() {
            [b'P', b'A', b'R', b'1', ..] => Box::new(parquet_file::open(&input, options)?),
            [0x93, b'N', b'U', b'M', b'P', b'Y', ..] | [b'P', b'K', 3 | 5, ..] => {
                Box::new(numpy_file::open(&input, options)?)
            }
            [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n', ..] => {
                Box::new(Bag::open(Mcap::new(input))?)
            }
            bytes if bytes.starts_with(&ulog::MAGIC) => Box::new(Bag::open(Ulog::new(input))?),
            bytes if bytes.starts_with(rosbag::MAGIC) => Box::new(Bag::open(Rosbag::new(input))?),
            bytes if bytes.starts_with(rosbag2::MAGIC) => Box::new(Bag::open(Rosbag2::new(input))?),
            bytes => match text_prefix(bytes) {
                Some(text) if is_metadata(&text) => {
                    return Err(LogError::Damaged(
                        "it is the metadata of a ROS 2 bag; expected the directory of the bag, or its .db3 or .mcap file".to_owned(),
                    ));
                }
                Some(text) => Box::new(match Output::recognise(&text) {
                    Some(output) => {
                        let table = cyclictest::open(&input, output)?;
                        options.ensure_no_time(&table.format())?;
                        table
                    }
                    None => delimited_text::open(&input, options)?,
                }),
                None => return Err(LogError::UnknownFormat { expected: FORMATS }),
            },
        };
        match source.is_bag() {
            true => options.ensure_no_time(&source.format())?,
            false => options.ensure_log_clock(&source.format())?,
        }
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

    /// Whether the file has messages on topics, whose order may differ from that of their stamps.
    pub fn is_bag(&self) -> bool {
        self.source.is_bag()
    }

    /// The distance of neighbouring numbers of floating point at the stamps of a topic, in s; 0 if the stamps are whole numbers.
    pub fn resolution(&self, topic: &str) -> f64 {
        self.source.resolution(topic)
    }

    /// Whether a signal is the column of time of a table.
    pub fn is_time(&self, name: &str) -> bool {
        self.source.is_time(name)
    }

    /// The first line of a text without a finite number in the column of time.
    pub(crate) fn time_gap(&self) -> Option<&Gap> {
        self.source.time_gap()
    }

    /// The only topic of a bag, or the column of time.
    ///
    /// # Errors
    /// In words, with the topics, if there are several.
    pub fn default_topic(&self) -> Result<String, String> {
        let topics = self.topics();
        match topics.as_slice() {
            [] => Err("it has no time stamps".to_owned()),
            [only] => Ok(only.name.clone()),
            [first, ..] if !self.is_bag() => {
                Ok(self.source.time_name().unwrap_or_else(|| first.name.clone()))
            }
            topics => {
                let names: Vec<_> =
                    topics.iter().take(20).map(|topic| format!("`{}`", topic.name)).collect();
                let (count, names) = (topics.len(), names.join(", "));
                Err(format!("it has {count} topics; expected --topic with one of {names}"))
            }
        }
    }

    /// Remarks about the file, such as a truncated end.
    pub fn notes(&self) -> Vec<String> {
        self.source.notes()
    }

    /// The notes that may change a result, such as a guessed unit or a missing end.
    pub fn warnings(&self) -> Vec<String> {
        without_headings(self.source.warnings(false))
    }

    /// As [`Log::warnings`], for results in the unit of the file: seconds that are assumed are no warning.
    pub fn warnings_in_own_unit(&self) -> Vec<String> {
        without_headings(self.source.warnings(true))
    }
}

fn without_headings(notes: Vec<String>) -> Vec<String> {
    let bare = |note: String| note.strip_prefix("warning: ").map(str::to_owned).unwrap_or(note);
    notes.into_iter().map(bare).collect()
}

/// What [`Log::open`] reads.
const FORMATS: &str = "MCAP, ROS 1 bag, ROS 2 bag in SQLite, ULog, CSV or other text (UTF-8, Latin-1, or UTF-16 with a byte order mark), Parquet, or NumPy (.npy, .npz)";
