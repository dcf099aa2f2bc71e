//! Measurement of the jitter of wake-ups.

mod load;
mod wakeup_times;

use std::io;

use thiserror::Error;

pub use wakeup_times::{Plan, Priority, WakeupTimes};

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
