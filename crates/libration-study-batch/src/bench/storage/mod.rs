//! Rates of storage, relative to copies of the same bytes.

mod disk;
mod replay;

use std::path::Path;

use libration_study::{Lab, StudyError};

use super::stopwatch::Rates;

/// A kind of storage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stored {
    /// 256 transitions drawn uniformly from a million.
    Sample,
    /// 256 drawn by priority, and given others.
    Prioritised,
    /// A rollout of 4096 × 16 into a replay buffer.
    Insert,
    /// A data set as NumPy's files.
    Npy,
    /// A data set as Parquet.
    Parquet,
    /// A million trajectories kept in a file, and taken up.
    Checkpoint,
}

impl Stored {
    /// All of them.
    pub const ALL: [Stored; 6] = [
        Stored::Sample,
        Stored::Prioritised,
        Stored::Insert,
        Stored::Npy,
        Stored::Parquet,
        Stored::Checkpoint,
    ];

    /// Its name in tables and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Stored::Sample => "sample",
            Stored::Prioritised => "prioritised",
            Stored::Insert => "insert",
            Stored::Npy => "npy",
            Stored::Parquet => "parquet",
            Stored::Checkpoint => "checkpoint",
        }
    }

    /// Returns the unit of the rate.
    pub const fn unit(self) -> &'static str {
        match self {
            Stored::Sample | Stored::Prioritised => "batches/s",
            Stored::Insert | Stored::Npy | Stored::Parquet => "transitions/s",
            Stored::Checkpoint => "trajectories/s",
        }
    }

    /// Returns the reference, if this program measures one.
    pub const fn against(self) -> Option<&'static str> {
        match self {
            Stored::Insert => Some("a copy of as many bytes in memory"),
            Stored::Npy => Some("a write of as many bytes to the disk"),
            Stored::Checkpoint => Some("a write of as many bytes as are kept and taken up"),
            Stored::Sample | Stored::Prioritised | Stored::Parquet => None,
        }
    }
}

/// Rate of a kind of storage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StorageRate {
    /// The measured case.
    pub stored: Stored,
    /// On how many threads.
    pub threads: usize,
    /// In its [unit](Stored::unit): the median of the rounds.
    pub median: f64,
    /// Distance of the quartiles of the rounds.
    pub spread: f64,
    /// The share of what it is compared with: the median of the rounds, and how far their quartiles lie apart.
    pub share: Option<[f64; 2]>,
    /// Number of rounds.
    pub rounds: usize,
}

impl StorageRate {
    fn new(stored: Stored, threads: usize, rates: &Rates, against: Option<&Rates>) -> Self {
        let share = against.map(|against| rates.over(against));
        StorageRate {
            stored,
            threads,
            median: rates.median(),
            spread: rates.spread(),
            share: share.map(|share| [share.median(), share.spread()]),
            rounds: rates.rounds(),
        }
    }
}

/// Times replay buffers in memory, and data sets and checkpoints in a folder of their own within `folder`.
///
/// # Errors
/// If the run is to stop, there is no memory, or the disk refuses.
pub fn storage(lab: &Lab<'_>, folder: &Path) -> Result<Vec<StorageRate>, StudyError> {
    let mut rates = replay::measure(lab)?;
    rates.extend(disk::measure(lab, folder)?);
    Ok(rates)
}
