//! Measurement of the jitter of wake-ups, and statistics of recorded clocks.

mod load;
mod spectrum;
mod statistics;
mod wakeup_times;

use std::io;
use std::path::Path;

use libration::control::clock::{Recorded, RecordedError};
use libration_data::read_text_bounded;
use thiserror::Error;

pub use spectrum::{Band, Spectrum};
pub use statistics::{Lateness, Quantile, Statistics};
pub use wakeup_times::{Plan, Priority, WakeupTimes};

/// Largest size of a file of time stamps in bytes: ten million stamps of about 20 bytes.
const LIMIT: u64 = 1 << 28;

/// Reads the time stamps of a file, in s.
///
/// # Errors
/// In words, if the file cannot be read or its time stamps are invalid.
pub fn read_time_stamps(path: &Path) -> Result<Vec<f64>, String> {
    let text = read_text_bounded(path, LIMIT).map_err(|error| error.to_string())?;
    let checked = |stamps: Vec<f64>| {
        Recorded::steps_between(&stamps)?;
        Ok::<_, RecordedError>(stamps)
    };
    Recorded::stamps_in(&text).and_then(checked).map_err(|error| error.to_string())
}

/// Error of a measurement of wake-ups.
#[derive(Debug, Error)]
pub enum JitterMeasurementError {
    /// A number is invalid.
    #[error("{name} is {value}; it must be {allowed}")]
    Value {
        /// The name of the number.
        name: &'static str,
        /// The value.
        value: f64,
        /// The allowed values.
        allowed: String,
    },
    /// The operating system does not allow a raised priority.
    #[error("the system does not allow a raised priority: {0}")]
    NotAllowed(String),
    /// The timer or the thread failed.
    #[error("the timer cannot be used: {0}")]
    Timer(#[from] io::Error),
    /// The user stopped the measurement before it had enough wake-ups.
    #[error("interrupted")]
    Interrupted,
}
