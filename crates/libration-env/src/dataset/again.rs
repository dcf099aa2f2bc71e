//! A data set compared with its manifest, and computed again.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use libration::ensemble::Execution;
use libration_data::{Chunk, Flaw, Folder, Manifest, checksum, find_unlisted};
use serde_json::Value;

use super::minari::Before;
use super::repair::{Described, broken, repair};
use super::room::Try;
use super::stream::{Course, head};
use super::tables::File;
use super::world::{Group, Number, Visit};
use super::{DataFormat, Dataset, DatasetError, Watch};
use crate::environments::{Actor, Batch};

/// What to do with a data set besides comparing its checksums.
#[derive(Clone, Copy, Debug, Default)]
pub struct Check<'a> {
    /// Compute all of it again, there, and compare the bits.
    pub replay: Option<&'a Execution>,
    /// Compute broken chunks again, there, and replace them.
    pub repair: Option<&'a Execution>,
}

/// Reads a data set and compares it with its manifest, repairs what is broken or computes all of it anew if `how` says so. Gives the
/// manifest and what is wrong in the end.
///
/// # Errors
/// If there is none, its settings cannot be read, or it is stopped; for a repair also if another process writes to it, or the system
/// refuses.
pub fn check(
    folder: &Path,
    how: Check<'_>,
    watch: &dyn Watch,
) -> Result<(Manifest, Vec<Flaw>), DatasetError> {
    let mut manifest = Manifest::read(folder)?;
    let told = settings(folder, &manifest);
    let (flaws, told) = match how.repair {
        None => (broken(folder, &manifest, watch)?, told),
        Some(execution) => {
            let (dataset, format, groups) = told?;
            let described = Described { dataset: &dataset, format, groups };
            if groups[0] < groups[1] {
                // Whatever cannot be is said before anything is read.
                let attempt = Try { dataset: &dataset, format, threads: execution.thread_count() };
                dataset.with(dataset.group(groups[0]), &Execution::serial(), attempt)??;
            }
            let folder = Folder::open(folder, &manifest.settings, true)?;
            manifest = folder.manifest().clone();
            let flaws = broken(folder.path(), &manifest, watch)?;
            let lost = repair(&folder, &described, &flaws, execution, watch)?;
            (lost, Ok((dataset, format, groups)))
        }
    };
    let mut flaws = flaws;
    match (told, how.replay) {
        (Ok((dataset, format, groups)), again) => {
            flaws.extend(whole(folder, &manifest, &dataset, groups)?);
            if let Some(execution) = again {
                flaws.extend(computed(&manifest, (&dataset, format, groups), execution, watch)?);
            }
        }
        (Err(error), Some(_)) => return Err(error),
        // What another version wrote can be compared with its checksums alone.
        (Err(_), None) => {}
    }
    Ok((manifest, flaws))
}

/// Whether all chunks are there, and nothing else.
fn whole(
    folder: &Path,
    manifest: &Manifest,
    dataset: &Dataset,
    [first, end]: [usize; 2],
) -> Result<Vec<Flaw>, DatasetError> {
    let (found, chunks) = (manifest.chunks.len() as u64, dataset.chunks());
    let wanted = (end - first) as u64 * chunks;
    let of_all = |path: &Path, what: String| {
        let (chunk, path) = (String::new(), path.to_owned());
        Flaw { chunk, path, what, broken: false }
    };
    // Those after the last are named below.
    let of_settings = manifest.chunks.get(..wanted as usize).unwrap_or(&manifest.chunks);
    if let Some(what) = misplaced(of_settings, [first, end], chunks) {
        let what = format!("cannot be continued: {what}");
        return Ok(vec![of_all(Path::new("manifest.jsonl"), what)]);
    }
    if found < wanted {
        let what = format!("is unfinished: {found} of {wanted} chunks; --resume goes on");
        return Ok(vec![of_all(Path::new("manifest.jsonl"), what)]);
    }
    let extra = manifest.chunks.get(wanted as usize..).unwrap_or_default().iter();
    let extra = extra.map(|chunk| Flaw {
        chunk: chunk.chunk.clone(),
        path: "manifest.jsonl".into(),
        what: "tells of it after the last that the settings lead to".to_owned(),
        broken: false,
    });
    let unlisted = find_unlisted(folder, manifest)?;
    let unlisted = unlisted.iter().map(|path| of_all(path, "is not in the manifest".to_owned()));
    Ok(extra.chain(unlisted).collect())
}

/// The first chunk that does not stand where it belongs, in words, if these are not the first ones of some groups in order; each group
/// has so many chunks.
pub(super) fn misplaced(all: &[Chunk], [first, end]: [usize; 2], chunks: u64) -> Option<String> {
    let wanted = |i: usize| {
        let (group, k) = (first as u64 + i as u64 / chunks, i as u64 % chunks);
        (group < end as u64).then(|| format!("{group:06}-{k:08}"))
    };
    let i = (0..all.len()).find(|&i| wanted(i).as_ref() != Some(&all[i].chunk))?;
    let place = wanted(i).map_or_else(
        || "after the last chunk".to_owned(),
        |wanted| format!("where {wanted} should"),
    );
    // The first line has the settings.
    let (found, line) = (&all[i].chunk, i + 2);
    let help = format!("delete line {line} and all lines after it, then run with --resume");
    Some(format!("chunk {found} stands {place}; help: {help}"))
}

/// The settings in a manifest.
pub(super) fn settings(
    folder: &Path,
    manifest: &Manifest,
) -> Result<(Dataset, DataFormat, [usize; 2]), DatasetError> {
    let refused = DatasetError::settings(folder);
    let told = |name: &str| manifest.settings.get(name).cloned().unwrap_or(Value::Null);
    let version = told("version");
    if version != env!("CARGO_PKG_VERSION") {
        let (folder, found) = (folder.to_owned(), version.to_string());
        return Err(DatasetError::Version { folder, found });
    }
    let file: File = serde_json::from_value(told("data")).map_err(|error| refused(&error))?;
    let dataset = Dataset::try_from(file).map_err(|fault| refused(&fault))?;
    let format = told("format").as_str().and_then(DataFormat::from_name);
    let format = format.ok_or_else(|| refused(&"`format` is none"))?;
    let groups: [usize; 2] =
        serde_json::from_value(told("groups")).map_err(|error| refused(&error))?;
    if groups[0] > groups[1] || groups[1] > dataset.groups() {
        return Err(refused(&format!("`groups` is {groups:?}")));
    }
    libration_data::ensure_same_settings(
        folder,
        &manifest.settings,
        &head(&dataset, format, groups),
    )?;
    Ok((dataset, format, groups))
}

fn computed(
    manifest: &Manifest,
    (dataset, format, [first, end]): (&Dataset, DataFormat, [usize; 2]),
    execution: &Execution,
    watch: &dyn Watch,
) -> Result<Vec<Flaw>, DatasetError> {
    let mut flaws = Vec::new();
    let each = dataset.chunks() as usize;
    for (i, number) in (first..end).enumerate() {
        let [begin, end] = [i, i + 1].map(|i| (i * each).min(manifest.chunks.len()));
        let chunks = begin..end;
        if chunks.is_empty() {
            break;
        }
        let (all, group, flaws) = (&manifest.chunks, dataset.group(number), &mut flaws);
        let compare = Compare { dataset, format, group, all, chunks, execution, watch, flaws };
        dataset.with(group, execution, compare)??;
    }
    Ok(flaws)
}

/// The chunks of a group, beside what the manifest says of them.
struct Compare<'a> {
    dataset: &'a Dataset,
    format: DataFormat,
    group: Group,
    /// All of the manifest, and which of them are the group's.
    all: &'a [Chunk],
    chunks: Range<usize>,
    execution: &'a Execution,
    watch: &'a dyn Watch,
    flaws: &'a mut Vec<Flaw>,
}

impl Visit for Compare<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number, const O: usize>(
        self,
        all: Box<dyn Batch<T, O>>,
        actor: Actor<'static, T, O>,
    ) -> Self::Output {
        let Compare { dataset, format, group, execution, watch, flaws, .. } = self;
        let mut course = Course::new(dataset, format, group, all, actor);
        let mut used = None;
        let mut before = Before::of(&self.all[..self.chunks.start]);
        for chunk in &self.all[self.chunks] {
            if watch.stops() {
                return Err(DatasetError::Interrupted);
            }
            let mut done = course.next(used.take())?;
            let (name, holds) = (done.name(), done.holds(dataset, format, before));
            let files = done.files(dataset, format, execution.thread_count(), before)?;
            before = files.after;
            let files = files.list();
            let mut flaw = |path: &Path, what: &str| {
                let (chunk, path, what) = (chunk.chunk.clone(), path.to_owned(), what.to_owned());
                flaws.push(Flaw { chunk, path, what, broken: false });
            };
            let stored = chunk.files.iter().map(|stored| (&stored.path, &stored.blake3));
            let mut stored: BTreeMap<_, _> = stored.collect();
            for file in &files {
                let sum = checksum(file.pieces.iter().copied());
                match stored.remove(&file.path) {
                    None => flaw(&file.path, "is missing in the manifest"),
                    Some(told) if *told != sum => {
                        flaw(&file.path, "holds other numbers than the settings lead to");
                    }
                    Some(_) => {}
                }
            }
            for path in stored.into_keys() {
                flaw(path, "is no file that the settings lead to");
            }
            if name != chunk.chunk || holds != chunk.holds {
                flaw(Path::new("manifest.jsonl"), "tells something else of the chunk");
            }
            watch.done(done.rollout.plan().transitions() as u64, 0);
            used = Some(done);
        }
        Ok(())
    }
}
