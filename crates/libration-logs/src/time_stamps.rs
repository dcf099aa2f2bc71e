//! The time stamps of a loop in a file of any format.

use std::path::Path;

use libration::control::clock::Recorded;

use crate::column::Gap;
use crate::{Log, ReadOptions};

/// Which time stamps of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StampOptions {
    /// The topic of a bag, or the column of a table. Default: the only topic, or the column of time.
    pub topic: Option<String>,
    /// How to read the file.
    pub read: ReadOptions,
}

/// The time stamps of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimeStamps {
    /// In s.
    pub seconds: Vec<f64>,
    /// The notes about the file that may change a result.
    pub warnings: Vec<String>,
    /// The distance of neighbouring numbers of floating point, in s; 0 if they are whole numbers in the file.
    pub resolution: f64,
    /// Whether they belong to the messages of a bag.
    pub is_of_bag: bool,
}

/// Reads the time stamps of a file, in s, as [`read_stamps_and_warnings`] without the warnings.
///
/// # Errors
/// As [`read_stamps_and_warnings`].
pub fn read_time_stamps(path: &Path, options: &StampOptions) -> Result<Vec<f64>, String> {
    read_stamps_and_warnings(path, options).map(|stamps| stamps.seconds)
}

/// Reads the time stamps of a file.
///
/// Messages of a bag may be in another order than their stamps, which are sorted. Without a topic, each line of a text must have a finite
/// number in its column of time.
///
/// # Errors
/// In words, if the file cannot be read or its time stamps are invalid.
pub fn read_stamps_and_warnings(path: &Path, options: &StampOptions) -> Result<TimeStamps, String> {
    let words = |error: &dyn std::fmt::Display| error.to_string();
    let log = Log::open(path, &options.read).map_err(|error| words(&error))?;
    let topic = match (&options.topic, log.time_gap()) {
        (Some(topic), _) => topic.clone(),
        (None, Some(Gap { line, text })) => {
            let name = log.default_topic()?;
            return Err(format!(
                "line {line} is `{text}`; it must have a finite number in the column of time, `{name}`"
            ));
        }
        (None, None) => log.default_topic()?,
    };
    let mut seconds = log.stamps(&topic).map_err(|error| words(&error))?;
    if log.is_bag() {
        seconds.sort_unstable_by(f64::total_cmp);
    }
    Recorded::steps_between(&seconds).map_err(|error| words(&error))?;
    let resolution = log.resolution(&topic);
    Ok(TimeStamps { seconds, warnings: log.warnings(), resolution, is_of_bag: log.is_bag() })
}
