//! Speeds of storage, relative to copies.

use libration_report::record::{Cell, Finding, Record, Table};
use libration_study::{Lab, StudyError};

use super::folder;
use crate::bench::{StorageRate, Stored, storage};
use crate::measurement::{Ratio, aim};

/// Returns the least share.
fn wanted(stored: Stored) -> Option<f64> {
    match stored {
        Stored::Insert | Stored::Npy => Some(0.8),
        Stored::Checkpoint => Some(0.5),
        Stored::Sample | Stored::Prioritised | Stored::Parquet => None,
    }
}

/// The work, in words.
fn work(stored: Stored) -> &'static str {
    match stored {
        Stored::Sample => "256 transitions drawn uniformly from a million",
        Stored::Prioritised => "256 drawn by priority from a million, and given other priorities",
        Stored::Insert => "a rollout of 4096 × 16 inserted into a buffer of a million",
        Stored::Npy => "a data set of random actions in NumPy’s files",
        Stored::Parquet => "the same as Parquet",
        Stored::Checkpoint => "a million trajectories kept in a file, and taken up",
    }
}

/// Returns the labels of a measurement and of its reference for tables.
fn copy_labels(stored: Stored) -> [&'static str; 2] {
    match stored {
        Stored::Sample => ["256 drawn uniformly", ""],
        Stored::Prioritised => ["256 drawn by priority, and changed", ""],
        Stored::Insert => ["4096 × 16 inserted", "a copy"],
        Stored::Npy => ["data set, npy", "a write"],
        Stored::Parquet => ["data set, Parquet", ""],
        Stored::Checkpoint => ["10⁶ trajectories kept, taken up", "two writes"],
    }
}

/// As texts name so many threads.
fn on(threads: usize) -> String {
    if threads == 1 { "one core".to_owned() } else { format!("{threads} cores") }
}

/// Times them, and judges their shares.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let columns = ["what", "threads", "10⁶ a second", "spread", "share", "wanted", "of"];
    let mut table = Table::new("speeds", &columns);
    for rate in storage(lab, &folder(lab))? {
        let StorageRate { stored, threads, .. } = rate;
        let id = format!("storage.{}", stored.name());
        let text = format!("{}, {}: {}", work(stored), on(threads), stored.unit());
        record.find(Finding::measured(format!("{id}.rate"), text, "1/s", rate.median));
        if let Some(([share, spread], against)) = rate.share.zip(stored.against()) {
            let text = format!("{}, {}: the speed of {against}", work(stored), on(threads));
            let ratio = Ratio::new(share, spread, rate.rounds);
            let reason = "what memory and disks do beside a copy is measured";
            aim(record, id, text, wanted(stored), ratio, reason);
        }
        let or_none = |x: Option<f64>| x.map_or_else(|| Cell::absent(""), |x| Cell::rounded(x, 2));
        let [what, of] = copy_labels(stored);
        table.push([
            what.into(),
            (threads as u64).into(),
            (rate.median / 1e6).into(),
            Cell::rounded(rate.spread / 1e6, 2),
            or_none(rate.share.map(|[share, _]| share)),
            or_none(wanted(stored)),
            if of.is_empty() { Cell::absent("") } else { of.into() },
        ]);
    }
    record.tables.push(table);
    Ok(())
}
