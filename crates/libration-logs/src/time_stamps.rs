//! The time stamps of a loop in a file of any format.

use std::path::Path;

use libration::control::clock::{Recorded, RecordedError};

use crate::input::Input;
use crate::{ClockChoice, Log, ReadOptions};

/// Largest size of a text of time stamps in bytes: ten million stamps of about 20 bytes.
const LIMIT: u64 = 1 << 28;

/// Which time stamps of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StampOptions {
    /// The topic of a bag, or the column of a table. Default: the only topic, or the column of time.
    pub topic: Option<String>,
    /// The clock of a bag.
    pub clock: ClockChoice,
}

/// Reads the time stamps of a file, in s.
///
/// Messages of a bag may be in another order than their stamps, which are sorted. A text without a topic has a stamp at the beginning
/// of each line, unless another column is named as one of time.
///
/// # Errors
/// In words, if the file cannot be read or its time stamps are invalid.
pub fn read_time_stamps(path: &Path, options: &StampOptions) -> Result<Vec<f64>, String> {
    let words = |error: &dyn std::fmt::Display| error.to_string();
    let input = Input::of(path).map_err(|error| words(&error))?;
    let read = ReadOptions { clock: options.clock, ..ReadOptions::default() };
    let log = match (Log::read(input.clone(), &read), &options.topic) {
        (Ok(log), None) if log.has_stamps_first() => return of_lines(&input),
        (Ok(log), _) => log,
        // The reader of lines has the position of an error in a text.
        (Err(_), None) if Log::is_text(&input) => return of_lines(&input),
        (Err(error), _) => return Err(words(&error)),
    };
    let topic = match &options.topic {
        Some(topic) => topic.clone(),
        None => log.default_topic()?,
    };
    let mut stamps = log.stamps(&topic).map_err(|error| words(&error))?;
    if log.is_bag() {
        stamps.sort_unstable_by(f64::total_cmp);
    }
    checked(stamps).map_err(|error| words(&error))
}

/// The stamps at the beginnings of the lines of a text.
fn of_lines(input: &Input) -> Result<Vec<f64>, String> {
    let bytes = input.bytes(LIMIT).map_err(|error| error.to_string())?;
    let text = std::str::from_utf8(&bytes).map_err(|error| error.to_string())?;
    Recorded::stamps_in(text).and_then(checked).map_err(|error| error.to_string())
}

fn checked(stamps: Vec<f64>) -> Result<Vec<f64>, RecordedError> {
    Recorded::steps_between(&stamps)?;
    Ok(stamps)
}
