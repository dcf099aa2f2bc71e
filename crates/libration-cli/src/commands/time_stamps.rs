//! Files of time stamps.

use std::path::Path;

use libration::control::clock::RecordedError;
use libration_logs::{StampOptions, read_time_stamps};

use crate::error::Failure;

/// Reads the time stamps, in seconds, of the file of an option, and converts them.
pub(super) fn read<T>(
    path: &Path,
    flag: &str,
    options: &StampOptions,
    make: impl FnOnce(Vec<f64>) -> Result<T, RecordedError>,
) -> Result<T, Failure> {
    let wrong = |reason: String| {
        Failure::usage(format!("cannot use `{}` ({flag}): {reason}", path.display()))
    };
    let stamps = read_time_stamps(path, options).map_err(wrong)?;
    make(stamps).map_err(|error| wrong(error.to_string()))
}
