//! Repair of broken files of a data set.

use std::collections::{BTreeMap, HashMap};
use std::ops::RangeInclusive;
use std::path::Path;

use libration::ensemble::Execution;
use libration_data::{
    Chunk, Comparison, Flaw, Folder, Manifest, NewFile, checksum, verify, write_files,
};

use super::group::{Group, GroupVisitor, Number};
use super::group_rollout::GroupRollout;
use super::minari::Totals;
use super::{DataFormat, Dataset, DatasetError, Monitor};
use crate::environments::AnyEnvironments;

/// The part of a data set in a folder: its format and groups of environments.
pub(super) struct DatasetPart<'a> {
    pub(super) dataset: &'a Dataset,
    pub(super) format: DataFormat,
    /// The first group, and the one after the last.
    pub(super) groups: [usize; 2],
}

/// Compares all files with the manifest and returns those that differ.
pub(super) fn find_broken(
    folder: &Path,
    manifest: &Manifest,
    comparison: Comparison,
    monitor: &dyn Monitor,
) -> Result<Vec<Flaw>, DatasetError> {
    let of = manifest.bytes();
    let flaws = verify(folder, manifest, comparison, |bytes| {
        if comparison == Comparison::Checksum {
            monitor.on_verified(bytes, of);
        }
        !monitor.should_stop()
    });
    if monitor.should_stop() { Err(DatasetError::Interrupted) } else { Ok(flaws) }
}

/// Recomputes the chunks of broken files and replaces these files atomically. Returns the remaining flaws: files that differ from
/// the recomputed ones, and folders in the place of files.
pub(super) fn repair(
    folder: &Folder,
    part: &DatasetPart<'_>,
    flaws: &[Flaw],
    execution: &Execution,
    monitor: &dyn Monitor,
) -> Result<Vec<Flaw>, DatasetError> {
    let DatasetPart { dataset, format, groups: [first, end] } = *part;
    let chunks = &folder.manifest().chunks;
    let numbers: HashMap<&str, usize> =
        chunks.iter().enumerate().map(|(i, chunk)| (&*chunk.chunk, i)).collect();
    let each = dataset.chunks() as usize;
    let mut lost = Vec::new();
    let mut of_groups: BTreeMap<usize, BTreeMap<usize, Vec<&Flaw>>> = BTreeMap::new();
    for flaw in flaws {
        if !flaw.broken {
            let what = format!("{}; cannot be repaired; help: remove it first", flaw.what);
            lost.push(Flaw { what, ..flaw.clone() });
            continue;
        }
        match numbers.get(&*flaw.chunk).map(|&number| (first + number / each, number)) {
            Some((group, number)) if group < end => {
                of_groups.entry(group).or_default().entry(number).or_default().push(flaw);
            }
            _ => lost.push(unrepairable(flaw)),
        }
    }
    for (number, broken) in of_groups {
        let (start, lost) = ((number - first) * each, &mut lost);
        let last = broken.keys().last().copied().unwrap_or(start);
        let (numbers, group) = (start..=last, dataset.group(number));
        let again = Recomputation {
            dataset,
            format,
            group,
            numbers,
            broken,
            folder,
            execution,
            monitor,
            lost,
        };
        dataset.with(group, execution, again)??;
    }
    Ok(lost)
}

/// The flaw of a file that differs from the recomputed one.
fn unrepairable(flaw: &Flaw) -> Flaw {
    let what = format!("{}; cannot be repaired: the settings give other bytes", flaw.what);
    Flaw { what, ..flaw.clone() }
}

/// The recomputation of the chunks of a group up to the last broken one.
struct Recomputation<'a> {
    dataset: &'a Dataset,
    format: DataFormat,
    group: Group,
    /// The indices of the chunks in the manifest.
    numbers: RangeInclusive<usize>,
    broken: BTreeMap<usize, Vec<&'a Flaw>>,
    folder: &'a Folder,
    execution: &'a Execution,
    monitor: &'a dyn Monitor,
    lost: &'a mut Vec<Flaw>,
}

impl GroupVisitor for Recomputation<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number>(self, all: Box<dyn AnyEnvironments<T>>) -> Self::Output {
        let Recomputation { dataset, format, group, folder, execution, monitor, lost, .. } = self;
        let chunks = &folder.manifest().chunks;
        let mut rollout = GroupRollout::new(dataset, format, group, all);
        let mut used = None;
        for number in self.numbers {
            if monitor.should_stop() {
                return Err(DatasetError::Interrupted);
            }
            let mut done = rollout.next(used.take())?;
            if let Some(flaws) = self.broken.get(&number) {
                let before = Totals::of_chunks(&chunks[..number]);
                let files = done.files(dataset, format, execution.thread_count(), before)?;
                let files = files.list();
                let mends = |flaw: &&Flaw| same(&files, &chunks[number], &flaw.path);
                let (mended, others): (Vec<&Flaw>, Vec<&Flaw>) =
                    flaws.iter().partition(|flaw| mends(flaw));
                let is_mended =
                    |file: &&NewFile<'_>| mended.iter().any(|flaw| flaw.path == file.path);
                let files: Vec<_> = files.iter().filter(is_mended).cloned().collect();
                write_files(folder.path(), &files)?;
                mended.into_iter().for_each(|flaw| monitor.on_repaired(flaw));
                lost.extend(others.into_iter().map(unrepairable));
            }
            used = Some(done);
        }
        Ok(())
    }
}

/// Whether a recomputed file matches the manifest.
fn same(files: &[NewFile<'_>], chunk: &Chunk, path: &Path) -> bool {
    let stored = chunk.files.iter().find(|stored| stored.path == path);
    let again = files.iter().find(|file| file.path == path);
    let is_same = stored.zip(again).map(|(stored, again)| {
        let bytes: u64 = again.pieces.iter().map(|piece| piece.len() as u64).sum();
        stored.bytes == bytes && stored.blake3 == checksum(again.pieces.iter().copied())
    });
    is_same.unwrap_or(false)
}
