//! How punctual a machine is: when a real loop wakes up, and what that makes of a clock.

mod load;
mod periodic;
mod spectrum;
mod statistics;

use std::io;
use std::path::Path;

use libration::control::clock::{Recorded, RecordedError};
use libration_data::read_text_bounded;
use thiserror::Error;

pub use periodic::{Plan, Priority, Wakeups};
pub use spectrum::{Band, Spectrum};
pub use statistics::{Lateness, Quantile, Statistics};

/// Bytes of the longest file of time stamps: ten million of them, hours of the fastest loops, take 20 bytes each.
const LIMIT: u64 = 1 << 28;

/// The time stamps of a file, in s, if they are the record of a clock.
///
/// # Errors
/// In words: what cannot be read, and what is none.
pub fn time_stamps(path: &Path) -> Result<Vec<f64>, String> {
    let text = read_text_bounded(path, LIMIT).map_err(|error| error.to_string())?;
    let checked = |stamps: Vec<f64>| {
        Recorded::steps_between(&stamps)?;
        Ok::<_, RecordedError>(stamps)
    };
    Recorded::stamps_in(&text).and_then(checked).map_err(|error| error.to_string())
}

/// Why no wake-ups were measured.
#[derive(Debug, Error)]
pub enum WakeupError {
    /// A number is none.
    #[error("{name} is {value}; it must be {allowed}")]
    Value {
        /// Which.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        allowed: String,
    },
    /// The system does not let this user raise a priority.
    #[error("the system does not allow a raised priority: {0}")]
    NotAllowed(String),
    /// There is no timer, or no thread.
    #[error("the timer cannot be used: {0}")]
    Timer(#[from] io::Error),
    /// The user asked for it to stop before there was anything to tell.
    #[error("interrupted")]
    Interrupted,
}
