//! Data sets, as Python has them written and checked.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use libration::ensemble::Execution;
use libration_env::dataset;
use libration_env::dataset::{Check, DataFormat, Dataset, Flaw, Job, Watch};
use pyo3::prelude::*;

use crate::error::{Raised, keywords, refused, unknown};
use crate::work::work;

/// What is done so far.
struct Done<'a> {
    transitions: &'a AtomicU64,
    bytes: &'a AtomicU64,
    repaired: &'a Mutex<Vec<Flaw>>,
    stop: &'a AtomicBool,
}

impl Watch for Done<'_> {
    fn done(&self, transitions: u64, bytes: u64) {
        self.transitions.fetch_add(transitions, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    fn checked(&self, bytes: u64, _: u64) {
        self.bytes.fetch_max(bytes, Ordering::Relaxed);
    }

    fn repaired(&self, flaw: &Flaw) {
        self.repaired.lock().unwrap_or_else(PoisonError::into_inner).push(flaw.clone());
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Settings of the default data set, with comments.
#[pyfunction]
pub(crate) fn _dataset_settings() -> &'static str {
    dataset::DEFAULT
}

/// How a data set is to be written.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Writing {
    out: PathBuf,
    transitions: Option<u64>,
    format: String,
    shard: [usize; 2],
    resume: bool,
    threads: usize,
}

/// Writes a data set, or goes on with one; tells `progress` how many transitions of how many, and how many bytes, are there. Gives
/// transitions, bytes and chunks.
#[pyfunction]
pub(crate) fn _write_dataset(
    py: Python<'_>,
    settings: &str,
    writing: Writing,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u64, u64, usize)> {
    let mut dataset: Dataset = dataset::parse(settings, "settings.toml").map_err(Raised::raised)?;
    if let Some(transitions) = writing.transitions {
        let told = |error| refused(format!("transitions is {transitions}: {error}"));
        dataset = dataset.transitions(transitions).map_err(told)?;
    }
    let format = DataFormat::from_name(&writing.format)
        .ok_or_else(|| unknown("format", &writing.format, DataFormat::ALL.map(DataFormat::name)))?;
    let job = Job {
        dataset: &dataset,
        format,
        shard: writing.shard,
        out: &writing.out,
        resume: writing.resume,
        execution: Execution::serial().threads(writing.threads).map_err(Raised::raised)?,
    };
    let all = if writing.shard[1] == 0 { 0 } else { dataset.share(writing.shard) };
    let (transitions, bytes, repaired) =
        (AtomicU64::new(0), AtomicU64::new(0), Mutex::new(Vec::new()));
    let manifest = work(
        py,
        |stop| {
            let watch =
                Done { transitions: &transitions, bytes: &bytes, repaired: &repaired, stop };
            dataset::write(&job, &watch)
        },
        teller(&transitions, &bytes, all, progress.as_ref()),
    )?;
    let chunks = manifest.map_err(Raised::raised)?.chunks.len();
    Ok((transitions.into_inner(), bytes.into_inner(), chunks))
}

/// A flaw: in which chunk, of which file, what it is, and whether it has been repaired.
type Told = (String, PathBuf, String, bool);

fn told(flaw: Flaw, repaired: bool) -> Told {
    (flaw.chunk, flaw.path, keywords(&flaw.what), repaired)
}

/// Reads a data set, and computes it or what is broken again if asked to. Gives what is or was wrong.
#[pyfunction]
pub(crate) fn _verify_dataset(
    py: Python<'_>,
    folder: PathBuf,
    replay: bool,
    repair: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Told>> {
    let again = Execution::serial().threads(threads).map_err(Raised::raised)?;
    let how = Check { replay: replay.then_some(&again), repair: repair.then_some(&again) };
    let (transitions, bytes, repaired) =
        (AtomicU64::new(0), AtomicU64::new(0), Mutex::new(Vec::new()));
    let checked = work(
        py,
        |stop| {
            let watch =
                Done { transitions: &transitions, bytes: &bytes, repaired: &repaired, stop };
            dataset::check(&folder, how, &watch)
        },
        teller(&transitions, &bytes, 0, progress.as_ref()),
    )?;
    let (_, flaws) = checked.map_err(Raised::raised)?;
    let repaired = repaired.into_inner().unwrap_or_else(PoisonError::into_inner);
    let repaired = repaired.into_iter().map(|flaw| told(flaw, true));
    Ok(repaired.chain(flaws.into_iter().map(|flaw| told(flaw, false))).collect())
}

/// Tells how far it is, whenever that has changed.
fn teller<'a>(
    transitions: &'a AtomicU64,
    bytes: &'a AtomicU64,
    all: u64,
    progress: Option<&'a Py<PyAny>>,
) -> impl FnMut(Python<'_>) -> PyResult<()> + 'a {
    let mut last = None;
    move |py| {
        let now = (transitions.load(Ordering::Relaxed), all, bytes.load(Ordering::Relaxed));
        match progress {
            Some(progress) if last != Some(now) => {
                last = Some(now);
                progress.call1(py, now).map(|_| ())
            }
            _ => Ok(()),
        }
    }
}
