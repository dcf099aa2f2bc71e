//! Files of time stamps.

use std::path::Path;

use libration::control::clock::RecordedError;
use libration_advise::wakeups;

use crate::error::Failure;

/// What `make` makes of the time stamps of a file, in seconds, that a flag names.
pub(super) fn read<T>(
    path: &Path,
    flag: &str,
    make: impl FnOnce(Vec<f64>) -> Result<T, RecordedError>,
) -> Result<T, Failure> {
    let wrong = |reason: String| {
        Failure::usage(format!("cannot use `{}` ({flag}): {reason}", path.display()))
    };
    let stamps = wakeups::time_stamps(path).map_err(wrong)?;
    make(stamps).map_err(|error| wrong(error.to_string()))
}
