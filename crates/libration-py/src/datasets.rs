//! Data sets, as Python has them written and checked.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use libration::ensemble::Execution;
use libration_lab::dataset::{self, DataFormat, Dataset, Job, Watch};
use pyo3::prelude::*;

use crate::error::{Raised, keywords, refused, unknown};
use crate::work::work;

/// What is done so far.
struct Done<'a> {
    transitions: &'a AtomicU64,
    bytes: &'a AtomicU64,
    stop: &'a AtomicBool,
}

impl Watch for Done<'_> {
    fn done(&self, transitions: u64, bytes: u64) {
        self.transitions.fetch_add(transitions, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
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
    let (transitions, bytes) = (AtomicU64::new(0), AtomicU64::new(0));
    let manifest = work(
        py,
        |stop| {
            let watch = Done { transitions: &transitions, bytes: &bytes, stop };
            dataset::write(&job, &watch)
        },
        teller(&transitions, &bytes, all, progress.as_ref()),
    )?;
    let chunks = manifest.map_err(Raised::raised)?.chunks.len();
    Ok((transitions.into_inner(), bytes.into_inner(), chunks))
}

/// A flaw: in which chunk, of which file, and what it is.
type Flaw = (String, PathBuf, String);

/// Reads a data set, and computes it again if asked to. Gives what is wrong, and how many bytes it is.
#[pyfunction]
pub(crate) fn _verify_dataset(
    py: Python<'_>,
    folder: PathBuf,
    replay: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<Flaw>, u64)> {
    let again = Execution::serial().threads(threads).map_err(Raised::raised)?;
    let (transitions, bytes) = (AtomicU64::new(0), AtomicU64::new(0));
    let checked = work(
        py,
        |stop| {
            let watch = Done { transitions: &transitions, bytes: &bytes, stop };
            dataset::check(&folder, replay.then_some(&again), &watch)
        },
        teller(&transitions, &bytes, 0, progress.as_ref()),
    )?;
    let (_, flaws) = checked.map_err(Raised::raised)?;
    let told =
        flaws.into_iter().map(|flaw| (flaw.chunk, flaw.path, keywords(&flaw.what))).collect();
    Ok((told, bytes.into_inner()))
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
