//! Broken files of a data set, computed again and replaced.

use std::collections::{BTreeMap, HashMap};
use std::ops::RangeInclusive;
use std::path::Path;

use libration::ensemble::Execution;
use libration_data::{Chunk, Flaw, Folder, Manifest, NewFile, checksum, verify, write_files};

use super::minari::Before;
use super::stream::Course;
use super::world::{Group, Number, Visit};
use super::{DataFormat, Dataset, DatasetError, Watch};
use crate::environments::{Actor, Batch};

/// What a manifest describes: a data set, its format, and which groups of environments.
pub(super) struct Described<'a> {
    pub(super) dataset: &'a Dataset,
    pub(super) format: DataFormat,
    /// The first group, and the one after the last.
    pub(super) groups: [usize; 2],
}

/// The files that are not what the manifest says. All are read.
pub(super) fn broken(
    folder: &Path,
    manifest: &Manifest,
    watch: &dyn Watch,
) -> Result<Vec<Flaw>, DatasetError> {
    let of = manifest.bytes();
    let flaws = verify(folder, manifest, |bytes| {
        watch.checked(bytes, of);
        !watch.stops()
    });
    if watch.stops() { Err(DatasetError::Interrupted) } else { Ok(flaws) }
}

/// Computes the chunks of broken files again and replaces these files, each whole or not at all. Gives the flaws that stay: those of
/// files that the settings do not lead to, and folders in the place of files.
pub(super) fn repair(
    folder: &Folder,
    described: &Described<'_>,
    flaws: &[Flaw],
    execution: &Execution,
    watch: &dyn Watch,
) -> Result<Vec<Flaw>, DatasetError> {
    let Described { dataset, format, groups: [first, end] } = *described;
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
            _ => lost.push(stays(flaw)),
        }
    }
    for (number, broken) in of_groups {
        let (start, lost) = ((number - first) * each, &mut lost);
        let last = broken.keys().last().copied().unwrap_or(start);
        let (numbers, group) = (start..=last, dataset.group(number));
        let again =
            Again { dataset, format, group, numbers, broken, folder, execution, watch, lost };
        dataset.with(group, execution, again)??;
    }
    Ok(lost)
}

/// A flaw that no computation mends.
fn stays(flaw: &Flaw) -> Flaw {
    let what = format!("{}; cannot be repaired: the settings lead to other bytes", flaw.what);
    Flaw { what, ..flaw.clone() }
}

/// The chunks of a group up to the last broken one.
struct Again<'a> {
    dataset: &'a Dataset,
    format: DataFormat,
    group: Group,
    /// Which of the manifest they are.
    numbers: RangeInclusive<usize>,
    broken: BTreeMap<usize, Vec<&'a Flaw>>,
    folder: &'a Folder,
    execution: &'a Execution,
    watch: &'a dyn Watch,
    lost: &'a mut Vec<Flaw>,
}

impl Visit for Again<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number, const O: usize>(
        self,
        all: Box<dyn Batch<T, O>>,
        actor: Actor<'static, T, O>,
    ) -> Self::Output {
        let Again { dataset, format, group, folder, execution, watch, lost, .. } = self;
        let chunks = &folder.manifest().chunks;
        let mut course = Course::new(dataset, format, group, all, actor);
        let mut used = None;
        for number in self.numbers {
            if watch.stops() {
                return Err(DatasetError::Interrupted);
            }
            let mut done = course.next(used.take())?;
            if let Some(flaws) = self.broken.get(&number) {
                let before = Before::of(&chunks[..number]);
                let files = done.files(dataset, format, execution.thread_count(), before)?;
                let files = files.list();
                let mends = |flaw: &&Flaw| same(&files, &chunks[number], &flaw.path);
                let (mended, others): (Vec<&Flaw>, Vec<&Flaw>) =
                    flaws.iter().partition(|flaw| mends(flaw));
                let is_mended =
                    |file: &&NewFile<'_>| mended.iter().any(|flaw| flaw.path == file.path);
                let files: Vec<_> = files.iter().filter(is_mended).cloned().collect();
                write_files(folder.path(), &files)?;
                mended.into_iter().for_each(|flaw| watch.repaired(flaw));
                lost.extend(others.into_iter().map(stays));
            }
            used = Some(done);
        }
        Ok(())
    }
}

/// Whether a file that was computed again is what the manifest says.
fn same(files: &[NewFile<'_>], chunk: &Chunk, path: &Path) -> bool {
    let stored = chunk.files.iter().find(|stored| stored.path == path);
    let again = files.iter().find(|file| file.path == path);
    let is_same = stored.zip(again).map(|(stored, again)| {
        let bytes: u64 = again.pieces.iter().map(|piece| piece.len() as u64).sum();
        stored.bytes == bytes && stored.blake3 == checksum(again.pieces.iter().copied())
    });
    is_same.unwrap_or(false)
}
