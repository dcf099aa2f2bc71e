//! Data sets and checkpoints on a disk, alternating with plain writes.

use std::fs;
use std::path::Path;
use std::time::Instant;

use libration::State;
use libration::ensemble::{Buffer, Ensemble, Execution, Pages};
use libration_data::{DataError, Durability, load_state, save_state, write_direct};
use libration_env::dataset;
use libration_env::dataset::{DataFormat, Dataset, Monitor, WriteJob};
use libration_study::{Lab, StudyError};
use serde_json::Value;
use tempfile::TempDir;

use super::{StorageRate, Stored};
use crate::bench::Rates;
use crate::dataset_error::failed;

/// Trajectories of a checkpoint.
const TRAJECTORIES: usize = 1_000_000;

/// The source's case with actions at random: what a policy does without noise would be compressed to nothing.
const SETTINGS: &str = "[policy.random]\n";

/// Bytes that are written from the same memory again and again.
const PIECE: usize = 1 << 26;

/// Watches nothing, but for the wish to stop.
struct Stop<'a>(&'a Lab<'a>);

impl Monitor for Stop<'_> {
    fn on_written(&self, _: u64, _: u64) {}

    fn should_stop(&self) -> bool {
        self.0.check().is_err()
    }
}

/// Times them on all cores.
pub(super) fn measure(lab: &Lab<'_>, folder: &Path) -> Result<Vec<StorageRate>, StudyError> {
    let folder = TempDir::new_in(folder).map_err(DataError::io("write", folder)).map_err(failed)?;
    let execution = lab.alone()?.threads(0)?;
    let threads = execution.thread_count();
    // A build that is not for speed is not to wait for compression. Of a long data set the first chunk, which waits for nothing, and
    // the last, for which nothing waits, are a small part.
    let few = if cfg!(debug_assertions) { [1 << 18; 2] } else { [1 << 24, 1 << 23] };
    let (rounds, transitions) =
        lab.effort.choose((3, few), (5, [1 << 27, 1 << 25]), (11, [1 << 28, 1 << 26]));
    let dataset = dataset::parse(SETTINGS, "settings").unwrap_or_default();
    let of = |count| dataset.clone().transitions(count).map_err(StudyError::Exact);
    let [long, short] = [of(transitions[0])?, of(transitions[1])?];
    let bench = Disk { lab, folder: folder.path(), execution };
    let mut seconds = [const { Vec::new() }; 5];
    for _ in 0..rounds {
        lab.check()?;
        let (npy, bytes) = bench.stream(&long, DataFormat::Npy)?;
        let (parquet, _) = bench.stream(&short, DataFormat::Parquet)?;
        let written = bench.write(bytes)?;
        let (kept, len) = bench.checkpoint()?;
        // What is kept and what is taken up.
        let once = bench.write(2 * len)?;
        for (all, one) in seconds.iter_mut().zip([npy, written, parquet, kept, once]) {
            all.push(one);
        }
    }
    let of = |i: usize, work: f64| Rates::of(seconds[i].iter().map(|s| work / s).collect());
    let [npy, written] = [0, 1].map(|i| of(i, long.len() as f64));
    let parquet = of(2, short.len() as f64);
    let [kept, once] = [3, 4].map(|i| of(i, TRAJECTORIES as f64));
    Ok(vec![
        StorageRate::new(Stored::Npy, threads, &npy, Some(&written)),
        StorageRate::new(Stored::Parquet, threads, &parquet, None),
        StorageRate::new(Stored::Checkpoint, threads, &kept, Some(&once)),
    ])
}

/// Where it is done, and what.
struct Disk<'a> {
    lab: &'a Lab<'a>,
    folder: &'a Path,
    execution: Execution,
}

impl Disk<'_> {
    /// Seconds for a data set, and its bytes.
    fn stream(&self, dataset: &Dataset, format: DataFormat) -> Result<(f64, u64), StudyError> {
        let out = self.folder.join(format.name());
        let job = WriteJob {
            dataset,
            format,
            shard: [1, 1],
            out: &out,
            resume: false,
            execution: self.execution.clone(),
        };
        let begun = Instant::now();
        let manifest = dataset::write(&job, &Stop(self.lab)).map_err(failed)?;
        let seconds = begun.elapsed().as_secs_f64();
        self.remove(&out)?;
        let files = manifest.chunks.iter().flat_map(|chunk| &chunk.files);
        Ok((seconds, files.map(|file| file.bytes).sum()))
    }

    /// Seconds for so many bytes that are there already.
    fn write(&self, bytes: u64) -> Result<f64, StudyError> {
        let len = usize::try_from(bytes).unwrap_or(usize::MAX);
        let mut memory = Buffer::<u8>::new(len.min(PIECE), Pages::Huge)?;
        memory.iter_mut().zip(0_u64..).for_each(|(byte, i)| *byte = (i * i % 251) as u8);
        let whole = std::iter::repeat_n(&memory[..], len / PIECE);
        let pieces: Vec<_> = whole.chain([&memory[..len % PIECE]]).collect();
        let path = self.folder.join("bytes");
        let begun = Instant::now();
        write_direct(&path, &pieces).map_err(failed)?;
        let seconds = begun.elapsed().as_secs_f64();
        self.remove(&path)?;
        Ok(seconds)
    }

    /// Seconds until a million trajectories are kept and taken up again, and the bytes of their file.
    fn checkpoint(&self) -> Result<(f64, u64), StudyError> {
        let make = |q: f64| {
            Ensemble::<f64, 1>::from_fn(TRAJECTORIES, self.execution.clone(), |i| State {
                q: [q + i as f64],
                v: [0.0],
            })
        };
        let (from, mut into) = (make(0.5)?, make(0.0)?);
        let path = self.folder.join("state");
        let begun = Instant::now();
        save_state(&path, &from, &Value::Null, Durability::System).map_err(failed)?;
        load_state(&path, &mut into).map_err(failed)?;
        let seconds = begun.elapsed().as_secs_f64();
        let len = fs::metadata(&path).map_or(0, |meta| meta.len());
        self.remove(&path)?;
        Ok((seconds, len))
    }

    fn remove(&self, path: &Path) -> Result<(), StudyError> {
        let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
        removed.map_err(DataError::io("remove", path)).map_err(failed)
    }
}
