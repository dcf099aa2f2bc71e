//! Files of time stamps.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use libration::control::clock::{Recorded, RecordedError};

use crate::error::Failure;

/// Bytes of the largest file of time stamps.
const MOST_TEXT: u64 = 256_000_000;

/// What `make` makes of the time stamps of a file, in seconds, that a flag names.
pub(super) fn read<T>(
    path: &Path,
    flag: &str,
    make: impl FnOnce(Vec<f64>) -> Result<T, RecordedError>,
) -> Result<T, Failure> {
    let wrong = |reason: String| {
        Failure::usage(format!("cannot use `{}` ({flag}): {reason}", path.display()))
    };
    let mut text = String::new();
    let file = File::open(path).map_err(|error| wrong(error.to_string()))?;
    // A device may have no end.
    let read = file.take(MOST_TEXT + 1).read_to_string(&mut text);
    if read.map_err(|error| wrong(error.to_string()))? as u64 > MOST_TEXT {
        return Err(wrong(format!("it is longer than {} MB", MOST_TEXT / 1_000_000)));
    }
    let made = Recorded::stamps_in(&text).and_then(make);
    made.map_err(|error| wrong(error.to_string()))
}
