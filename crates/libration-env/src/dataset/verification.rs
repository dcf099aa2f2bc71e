//! Verification of data sets.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use libration::ensemble::Execution;
use libration_data::{Chunk, Comparison, Flaw, Folder, Manifest, checksum, find_unlisted};
use serde_json::Value;

use super::chunk_order::find_misplaced;
use super::group::{Group, GroupVisitor, Number};
use super::group_rollout::GroupRollout;
use super::manifest_settings::manifest_head;
use super::memory_check::TrialStep;
use super::minari::Totals;
use super::repair::{DatasetPart, find_broken, repair};
use super::tables::File;
use super::{DataFormat, Dataset, DatasetError, Monitor, resume_state};
use crate::environments::AnyEnvironments;

/// Options of a verification beyond the comparison of checksums.
#[derive(Clone, Copy, Debug, Default)]
pub struct VerifyOptions<'a> {
    /// Recompute the data set with this execution and compare the bits.
    pub replay: Option<&'a Execution>,
    /// Recompute broken chunks with this execution and replace them.
    pub repair: Option<&'a Execution>,
}

/// A verified data set.
#[derive(Debug)]
pub struct Verification {
    /// Its manifest.
    pub manifest: Manifest,
    /// The remaining flaws.
    pub flaws: Vec<Flaw>,
    /// The parts that were not compared with anything, each in words.
    pub not_examined: Vec<String>,
}

/// Reads a data set and compares it with its manifest; repairs or recomputes it with the options `how`.
///
/// # Errors
/// If there is no data set or the work is stopped; for a replay or a repair also if its settings cannot be read, and for a repair if
/// another process writes to it, or a file cannot be written.
pub fn verify(
    folder: &Path,
    how: VerifyOptions<'_>,
    monitor: &dyn Monitor,
) -> Result<Verification, DatasetError> {
    let mut manifest = Manifest::read(folder)?;
    let value = settings(folder, &manifest);
    let (flaws, value) = match how.repair {
        None => (find_broken(folder, &manifest, Comparison::Checksum, monitor)?, value),
        Some(execution) => {
            let (dataset, format, groups) = value?;
            let part = DatasetPart { dataset: &dataset, format, groups };
            if groups[0] < groups[1] {
                // Invalid settings fail before any file is read.
                let attempt =
                    TrialStep { dataset: &dataset, format, threads: execution.thread_count() };
                dataset.with(dataset.group(groups[0]), &Execution::serial(), attempt)??;
            }
            let folder = Folder::open(folder, &manifest.settings, true)?;
            manifest = folder.manifest().clone();
            let flaws = find_broken(folder.path(), &manifest, Comparison::Checksum, monitor)?;
            let lost = repair(&folder, &part, &flaws, execution, monitor)?;
            (lost, Ok((dataset, format, groups)))
        }
    };
    let (mut flaws, mut not_examined) = (flaws, Vec::new());
    match (value, how.replay) {
        (Ok((dataset, format, groups)), again) => {
            let incomplete = check_completeness(folder, &manifest, &dataset, groups)?;
            match again {
                Some(execution) => flaws.extend(compare_recomputed(
                    &manifest,
                    (&dataset, format, groups),
                    execution,
                    monitor,
                )?),
                None => {
                    // Entries in another order are those of other chunks.
                    if incomplete.is_empty() {
                        flaws.extend(check_entries(&manifest, &dataset, format, groups[0]));
                    }
                    not_examined.extend(only_recomputed(format));
                }
            }
            flaws.extend(incomplete);
        }
        (Err(error), Some(_)) => return Err(error),
        (Err(error @ DatasetError::Version { .. }), None) => {
            not_examined.push(format!("all but checksums ({error})"));
        }
        (Err(error), None) => {
            let what = format!("has a first line that this version does not write: {error}");
            flaws.push(of_all("manifest.jsonl", what));
        }
    }
    Ok(Verification { manifest, flaws, not_examined })
}

/// The parts that a recomputation alone compares.
fn only_recomputed(format: DataFormat) -> Vec<String> {
    let counts = match format {
        DataFormat::Minari => "`ends`, `episodes` and `actions`",
        DataFormat::Npy | DataFormat::Parquet => "`ends`",
    };
    vec![
        "whether the settings lead to these files".to_owned(),
        format!("the counts {counts} of the manifest (`--replay` recomputes both)"),
    ]
}

/// A flaw of a data set as a whole.
fn of_all(path: impl Into<PathBuf>, what: String) -> Flaw {
    Flaw { chunk: String::new(), path: path.into(), what, broken: false }
}

/// The missing, misplaced and extra chunks, and files that are not in the manifest.
fn check_completeness(
    folder: &Path,
    manifest: &Manifest,
    dataset: &Dataset,
    [first, end]: [usize; 2],
) -> Result<Vec<Flaw>, DatasetError> {
    let (found, chunks) = (manifest.chunks.len() as u64, dataset.chunks());
    let wanted = (end - first) as u64 * chunks;
    // Chunks after the last are reported below.
    let of_settings = manifest.chunks.get(..wanted as usize).unwrap_or(&manifest.chunks);
    if let Some(what) = find_misplaced(of_settings, [first, end], chunks) {
        let what = format!("cannot be continued: {what}");
        return Ok(vec![of_all("manifest.jsonl", what)]);
    }
    if found < wanted {
        let what = format!("is unfinished: {found} of {wanted} chunks; --resume continues it");
        return Ok(vec![of_all("manifest.jsonl", what)]);
    }
    let extra = manifest.chunks.get(wanted as usize..).unwrap_or_default().iter();
    let extra = extra.map(|chunk| Flaw {
        chunk: chunk.chunk.clone(),
        path: "manifest.jsonl".into(),
        what: "lists it after the last chunk of the settings".to_owned(),
        broken: false,
    });
    let unlisted = find_unlisted(folder, manifest)?;
    // Killed before it was removed, or not yet finished.
    let unlisted = unlisted.iter().filter(|path| **path != Path::new(resume_state::NAME));
    let unlisted = unlisted.map(|path| of_all(path, "is not in the manifest".to_owned()));
    Ok(extra.chain(unlisted).collect())
}

/// The entries of chunks that say something else than the settings. Checksums compare files with a manifest, and not a manifest itself.
fn check_entries(
    manifest: &Manifest,
    dataset: &Dataset,
    format: DataFormat,
    first: usize,
) -> Vec<Flaw> {
    let mut before = [0, 0];
    let of = |(i, chunk): (usize, &Chunk)| {
        let number = first + i / dataset.chunks() as usize;
        let step = i as u64 % dataset.chunks();
        let key = dataset.misstated(number, step, format, &mut before, &chunk.holds)?;
        let stated = chunk.holds.get(&key).map_or_else(|| "none".to_owned(), Value::to_string);
        let what = format!("states {stated} as `{key}`, which is not that of the settings");
        let (chunk, path) = (chunk.chunk.clone(), "manifest.jsonl".into());
        Some(Flaw { chunk, path, what, broken: false })
    };
    manifest.chunks.iter().enumerate().filter_map(of).collect()
}

/// Reads the settings in a manifest.
pub(super) fn settings(
    folder: &Path,
    manifest: &Manifest,
) -> Result<(Dataset, DataFormat, [usize; 2]), DatasetError> {
    let settings_error = DatasetError::settings(folder);
    let value = |name: &str| manifest.settings.get(name).cloned().unwrap_or(Value::Null);
    let version = value("version");
    if version != env!("CARGO_PKG_VERSION") {
        let (folder, found) = (folder.to_owned(), version.to_string());
        return Err(DatasetError::Version { folder, found });
    }
    let file: File =
        serde_json::from_value(value("data")).map_err(|error| settings_error(&error))?;
    let dataset = Dataset::try_from(file).map_err(|fault| settings_error(&fault))?;
    let format = value("format").as_str().and_then(DataFormat::from_name);
    let format = format.ok_or_else(|| settings_error(&"`format` is none"))?;
    let groups: [usize; 2] =
        serde_json::from_value(value("groups")).map_err(|error| settings_error(&error))?;
    if groups[0] > groups[1] || groups[1] > dataset.groups() {
        return Err(settings_error(&format!("`groups` is {groups:?}")));
    }
    libration_data::ensure_same_settings(
        folder,
        &manifest.settings,
        &manifest_head(&dataset, format, groups),
    )?;
    Ok((dataset, format, groups))
}

fn compare_recomputed(
    manifest: &Manifest,
    (dataset, format, [first, end]): (&Dataset, DataFormat, [usize; 2]),
    execution: &Execution,
    monitor: &dyn Monitor,
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
        let compare = Compare { dataset, format, group, all, chunks, execution, monitor, flaws };
        dataset.with(group, execution, compare)??;
    }
    Ok(flaws)
}

/// The comparison of the recomputed chunks of a group with the manifest.
struct Compare<'a> {
    dataset: &'a Dataset,
    format: DataFormat,
    group: Group,
    /// All chunks of the manifest, and the range of the group.
    all: &'a [Chunk],
    chunks: Range<usize>,
    execution: &'a Execution,
    monitor: &'a dyn Monitor,
    flaws: &'a mut Vec<Flaw>,
}

impl GroupVisitor for Compare<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number>(self, all: Box<dyn AnyEnvironments<T>>) -> Self::Output {
        let Compare { dataset, format, group, execution, monitor, flaws, .. } = self;
        let mut rollout = GroupRollout::new(dataset, format, group, all);
        let mut used = None;
        let mut before = Totals::of_chunks(&self.all[..self.chunks.start]);
        for chunk in &self.all[self.chunks] {
            if monitor.should_stop() {
                return Err(DatasetError::Interrupted);
            }
            let mut done = rollout.next(used.take())?;
            let (name, holds) = (done.name(), done.manifest_entry(dataset, format, before));
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
                    Some(value) if *value != sum => {
                        flaw(&file.path, "differs from the numbers of the settings");
                    }
                    Some(_) => {}
                }
            }
            for path in stored.into_keys() {
                flaw(path, "is not a file of the settings");
            }
            if name != chunk.chunk || holds != chunk.holds {
                flaw(Path::new("manifest.jsonl"), "has another entry for the chunk");
            }
            monitor.on_written(done.rollout.plan().transitions() as u64, 0);
            used = Some(done);
        }
        Ok(())
    }
}
