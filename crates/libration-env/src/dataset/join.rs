//! Joining the shards of a data set.

use std::path::{Path, PathBuf};

use libration_data::{
    Chunk, Comparison, Folder, Manifest, Transfer, ensure_same_settings, transfer_files,
};
use serde_json::Value;

use super::chunk_order::find_misplaced;
use super::manifest_settings::manifest_head;
use super::repair::find_broken;
use super::verification::settings;
use super::{DataFormat, Dataset, DatasetError, Monitor};

/// Chunks that are recorded at once: to wait for the disk takes as long for one as for all of them.
const AT_ONCE: usize = 64;

/// The shards to join, in any order.
#[derive(Clone, Copy, Debug)]
pub struct JoinJob<'a> {
    /// The folders of the shards.
    pub parts: &'a [PathBuf],
    /// The folder of the whole data set.
    pub out: &'a Path,
    /// How files come there.
    pub transfer: Transfer,
    /// Whether to resume an interrupted join.
    pub resume: bool,
}

/// A shard: its folder, its manifest, and its first group and the one after the last.
struct Part<'a> {
    folder: &'a Path,
    manifest: Manifest,
    groups: [usize; 2],
}

/// Joins the shards of a data set. The result has the bytes of the data set that one run writes. Returns the manifest.
///
/// # Errors
/// Before anything is written, if the shards are of different data sets, one is missing, unfinished or given twice, or a file is
/// missing or has another length. [`DatasetError`] with the file, if one has another checksum or cannot be written.
pub fn join(job: &JoinJob<'_>, monitor: &dyn Monitor) -> Result<Manifest, DatasetError> {
    let (parts, dataset, format) = parts_in_order(job.parts)?;
    for part in &parts {
        let flaws = find_broken(part.folder, &part.manifest, Comparison::Length, monitor)?;
        if let Some(flaw) = flaws.first() {
            let what = format!(
                "{} {}; help: repair it with verify --repair",
                flaw.path.display(),
                flaw.what
            );
            return Err(part.unusable(what));
        }
    }
    ensure_outside(job.out, &parts)?;
    let all = [0, dataset.groups()];
    let mut folder = Folder::open(job.out, &manifest_head(&dataset, format, all), job.resume)?;
    if let Some(what) = find_misplaced(&folder.manifest().chunks, all, dataset.chunks()) {
        return Err(DatasetError::Order { folder: job.out.to_owned(), what });
    }
    let of_parts = parts.iter().flat_map(|part| &part.manifest.chunks);
    let other = folder.manifest().chunks.iter().zip(of_parts).position(|(own, part)| own != part);
    if let Some(i) = other {
        // The first line has the settings.
        let what = format!(
            "line {} is not that of the shards; help: delete it and all lines after it, then run with --resume",
            i + 2
        );
        return Err(DatasetError::Order { folder: job.out.to_owned(), what });
    }
    let transitions =
        |chunk: &Chunk| chunk.holds.get("transitions").and_then(Value::as_u64).unwrap_or(0);
    let mut there = folder.manifest().chunks.len();
    for chunk in &folder.manifest().chunks {
        monitor.on_present(transitions(chunk), chunk.bytes());
    }
    for part in &parts {
        let skipped = there.min(part.manifest.chunks.len());
        there -= skipped;
        for chunks in part.manifest.chunks[skipped..].chunks(AT_ONCE) {
            if monitor.should_stop() {
                return Err(DatasetError::Interrupted);
            }
            let files: Vec<_> = chunks.iter().flat_map(|chunk| chunk.files.clone()).collect();
            transfer_files(part.folder, folder.path(), &files, job.transfer)?;
            folder.record_all(chunks)?;
            chunks.iter().for_each(|chunk| monitor.on_written(transitions(chunk), chunk.bytes()));
        }
    }
    Ok(folder.manifest().clone())
}

/// Checks that the folder of the whole data set is in none of the shards, which would have a file too many.
fn ensure_outside(out: &Path, parts: &[Part<'_>]) -> Result<(), DatasetError> {
    let out = std::path::absolute(out).unwrap_or_else(|_| out.to_owned());
    let existing = out.ancestors().find_map(|folder| folder.canonicalize().ok());
    for part in parts {
        let within = part.folder.canonicalize().ok().zip(existing.as_ref());
        if within.is_some_and(|(part, out)| out.starts_with(&part)) {
            return Err(
                part.unusable("contains the output folder; help: choose another --out".to_owned())
            );
        }
    }
    Ok(())
}

/// The shards in the order of their groups, once they are known to be those of one data set, each of them finished.
fn parts_in_order(
    folders: &[PathBuf],
) -> Result<(Vec<Part<'_>>, Dataset, DataFormat), DatasetError> {
    let mut whole: Option<(Dataset, DataFormat)> = None;
    let mut parts = Vec::new();
    for folder in folders {
        let manifest = Manifest::read(folder)?;
        let (dataset, format, groups) = settings(folder, &manifest)?;
        let (first, first_format) = whole.get_or_insert((dataset, format));
        ensure_same_settings(
            folder,
            &manifest.settings,
            &manifest_head(first, *first_format, groups),
        )?;
        let part = Part { folder, manifest, groups };
        part.ensure_finished(first.chunks())?;
        part.ensure_contents(first, *first_format)?;
        parts.push(part);
    }
    let Some((dataset, format)) = whole else {
        return Err(DatasetError::Parts {
            what: "there are none; expected the folders of shards".to_owned(),
        });
    };
    parts.sort_by_key(|part| part.groups);
    let mut next = 0;
    for (i, part) in parts.iter().enumerate() {
        let [first, end] = part.groups;
        if first < next {
            let [one, other] = [&parts[i - 1], part].map(|part| part.folder.display());
            let what = format!("group {first} of environments is in {one} and in {other}");
            return Err(DatasetError::Parts { what });
        }
        if first > next {
            return Err(missing_groups(next, first));
        }
        next = end;
    }
    if next < dataset.groups() {
        return Err(missing_groups(next, dataset.groups()));
    }
    Ok((parts, dataset, format))
}

/// The error of the groups from `first` up to the one before `end`, which no shard has.
fn missing_groups(first: usize, end: usize) -> DatasetError {
    let last = end - 1;
    let which =
        if first == last { format!("group {first}") } else { format!("groups {first} to {last}") };
    DatasetError::Parts {
        what: format!("{which} of environments: in none of the folders; is a shard missing?"),
    }
}

impl Part<'_> {
    fn unusable(&self, what: String) -> DatasetError {
        DatasetError::Part { folder: self.folder.to_owned(), what }
    }

    /// Checks that the manifest says of each chunk what the settings say.
    fn ensure_contents(&self, dataset: &Dataset, format: DataFormat) -> Result<(), DatasetError> {
        let [first, _] = self.groups;
        let mut before = [0, 0];
        for (i, chunk) in self.manifest.chunks.iter().enumerate() {
            let number = first + i / dataset.chunks() as usize;
            let step = i as u64 % dataset.chunks();
            let found = dataset.misstated(number, step, format, &mut before, &chunk.holds);
            if let Some(key) = found {
                // The first line has the settings.
                let what = format!(
                    "line {} of its manifest has another `{key}` than the settings; help: write the shard again",
                    i + 2
                );
                return Err(self.unusable(what));
            }
        }
        Ok(())
    }

    /// Checks that each group has `chunks` chunks, in order.
    fn ensure_finished(&self, chunks: u64) -> Result<(), DatasetError> {
        let [first, end] = self.groups;
        if let Some(what) = find_misplaced(&self.manifest.chunks, self.groups, chunks) {
            return Err(DatasetError::Order { folder: self.folder.to_owned(), what });
        }
        let (found, wanted) = (self.manifest.chunks.len(), (end - first) as u64 * chunks);
        if (found as u64) < wanted {
            let help = "finish it with rollout --resume";
            return Err(
                self.unusable(format!("is unfinished: {found} of {wanted} chunks; help: {help}"))
            );
        }
        Ok(())
    }
}
