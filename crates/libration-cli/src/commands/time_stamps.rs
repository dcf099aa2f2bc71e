//! Files of time stamps.

use std::ops::RangeInclusive;
use std::path::Path;

use libration::control::clock::RecordedError;
use libration_advise::Doubt;
use libration_logs::{StampOptions, TimeStamps, read_stamps_and_warnings};
use libration_report::notation::number;

use super::log_warnings;
use super::measure_jitter::time;
use crate::error::Failure;

/// Reads the time stamps of the file of an option, prints the warnings about it, and converts the stamps.
pub(super) fn read<T>(
    path: &Path,
    flag: &str,
    options: &StampOptions,
    make: impl FnOnce(TimeStamps) -> Result<T, RecordedError>,
) -> Result<T, Failure> {
    let stamps = load(path, flag, options)?;
    log_warnings::warn(path, &stamps.warnings);
    make(stamps).map_err(|error| wrong(path, flag, &error.to_string()))
}

/// Notes on a record that a loop replays.
#[derive(Default)]
pub(super) struct RecordNotes {
    /// The warnings about the file.
    pub(super) warnings: Vec<String>,
    /// Why the record decides nothing, with its warning.
    pub(super) doubt: Option<(Doubt, String)>,
}

/// Reads the time stamps of the file of `--jitter-file`, whose mean interval over the period lies in `range`, and converts them.
pub(super) fn read_for_period<T>(
    path: &Path,
    options: &StampOptions,
    period: f64,
    range: RangeInclusive<f64>,
    make: impl FnOnce(&[f64]) -> Result<T, RecordedError>,
) -> Result<(T, RecordNotes), Failure> {
    const FLAG: &str = "--jitter-file";
    let TimeStamps { seconds, warnings, is_of_bag, .. } = load(path, FLAG, options)?;
    let fails = |why: &str| wrong(path, FLAG, why);
    let span = seconds.last().zip(seconds.first()).map_or(0.0, |(last, first)| last - first);
    let mean = span / seconds.len().saturating_sub(1).max(1) as f64;
    let ratio = mean / period;
    if !range.contains(&ratio) {
        let help = match is_of_bag {
            true => "choose a --topic with one message per period",
            false => {
                "give the unit of the time stamps with --time-unit, or choose their column with --time"
            }
        };
        return Err(fails(&format!(
            "the mean interval of the record is {} times the period ({} and {}); expected {} to {} times; help: {help}",
            number(ratio, 3),
            time(mean),
            time(period),
            range.start(),
            range.end()
        )));
    }
    let made = make(&seconds).map_err(|error| fails(&error.to_string()))?;
    let doubt = other_clock(period, mean).or_else(|| short_record(seconds.len()));
    Ok((made, RecordNotes { warnings, doubt }))
}

/// Largest relative difference of the mean interval of the clock of a loop from its period.
const OTHER_RATE: f64 = 0.05;

/// A warning if the mean interval of a record is not the period of a loop, both in s.
fn other_clock(period: f64, mean: f64) -> Option<(Doubt, String)> {
    let is_other = (mean / period - 1.0).abs() > OTHER_RATE;
    is_other.then(|| {
        let warning = format!(
            "the mean interval of the record is {}, the period of the loop {}: the record is not the clock of this loop; \
             help: choose a --topic with one message per period",
            time(mean),
            time(period)
        );
        (Doubt::OtherClock, warning)
    })
}

/// Intervals below which a record does not show how a clock jitters: the rms of twenty is known within a sixth.
const FEW: usize = 20;

/// A warning if a record has few intervals.
fn short_record(stamps: usize) -> Option<(Doubt, String)> {
    let intervals = stamps.saturating_sub(1);
    (intervals < FEW).then(|| {
        let warning = format!("the record has {intervals} intervals; expected at least {FEW}");
        (Doubt::ShortRecord, warning)
    })
}

fn load(path: &Path, flag: &str, options: &StampOptions) -> Result<TimeStamps, Failure> {
    read_stamps_and_warnings(path, options).map_err(|why| wrong(path, flag, &why))
}

fn wrong(path: &Path, flag: &str, reason: &str) -> Failure {
    Failure::usage(format!("cannot use `{}` ({flag}): {reason}", path.display()))
}
