//! Logs of real loops: signals and time stamps in the files that people record.
//!
//! [`Log::open`] recognises the format of a file by its first bytes. [`Log::series`] returns a signal over time, [`Log::stamps`] the
//! time stamps of a topic. Memory is bounded: no count in a file is trusted before its bytes are there.

mod arrow_schema;
mod bag;
mod bag_directory;
pub mod clock;
mod column;
mod column_builder;
mod cyclictest;
mod delimited_text;
mod error;
mod input;
mod iso_8601;
mod json_message;
mod log;
mod mcap;
mod nearest_name;
mod numpy_file;
mod parquet_file;
mod read_options;
mod ros;
mod rosbag;
mod rosbag2;
mod signal;
mod source;
mod split_stamps;
mod sqlite;
mod table;
mod text_encoding;
mod text_line;
mod time_stamps;
mod time_unit;
mod ulog;
mod unpack_budget;

pub use clock::{Band, Lateness, Quantile, Spectrum, Statistics};
pub use error::LogError;
pub use log::Log;
pub use parquet_file::PARQUET_THREAD;
pub use read_options::ReadOptions;
pub use signal::{ClockChoice, Series, SignalInfo, TopicInfo};
pub use time_stamps::{StampOptions, TimeStamps, read_stamps_and_warnings, read_time_stamps};
pub use time_unit::TimeUnit;
