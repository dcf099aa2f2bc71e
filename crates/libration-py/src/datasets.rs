//! Writing and checking data sets for Python.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use libration::ensemble::Execution;
use libration_env::dataset;
use libration_env::dataset::{
    DataFormat, Dataset, EquationSource, Flaw, JoinJob, Monitor, Transfer, Verification,
    VerifyOptions, WriteJob,
};
use pyo3::prelude::*;

use crate::background::run_in_background;
use crate::equations::EquationText;
use crate::error::{Raised, keywords, unknown, value_error};

/// Progress of a data set.
struct ProgressWatch<'a> {
    transitions: &'a AtomicU64,
    bytes: &'a AtomicU64,
    repaired: &'a Mutex<Vec<Flaw>>,
    stop: &'a AtomicBool,
}

impl Monitor for ProgressWatch<'_> {
    fn on_written(&self, transitions: u64, bytes: u64) {
        self.transitions.fetch_add(transitions, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    fn on_verified(&self, bytes: u64, _: u64) {
        self.bytes.fetch_max(bytes, Ordering::Relaxed);
    }

    fn on_repaired(&self, flaw: &Flaw) {
        self.repaired.lock().unwrap_or_else(PoisonError::into_inner).push(flaw.clone());
    }

    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Settings of the default data set, with comments.
#[pyfunction]
pub(crate) fn _dataset_settings() -> &'static str {
    dataset::DEFAULT
}

/// Options of a data set.
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
    system: Option<EquationText>,
    writing: Writing,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u64, u64, usize)> {
    let parsed = match &system {
        None => dataset::parse(settings, "settings.toml"),
        Some((text, name, set)) => {
            let source = EquationSource::Text { name, text };
            dataset::parse_of(source, set, settings, "settings.toml")
        }
    };
    let mut dataset: Dataset = parsed.map_err(Raised::raised)?;
    if let Some(transitions) = writing.transitions {
        let with_name = |error| value_error(format!("transitions is {transitions}: {error}"));
        dataset = dataset.transitions(transitions).map_err(with_name)?;
    }
    let format = DataFormat::from_name(&writing.format)
        .ok_or_else(|| unknown("format", &writing.format, DataFormat::ALL.map(DataFormat::name)))?;
    let job = WriteJob {
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
    let manifest = run_in_background(
        py,
        |stop| {
            let watch = ProgressWatch {
                transitions: &transitions,
                bytes: &bytes,
                repaired: &repaired,
                stop,
            };
            dataset::write(&job, &watch)
        },
        progress_callback(&transitions, &bytes, all, progress.as_ref()),
    )?;
    let chunks = manifest.map_err(Raised::raised)?.chunks.len();
    Ok((transitions.into_inner(), bytes.into_inner(), chunks))
}

/// Joins the shards of a data set. Gives transitions, bytes and chunks.
#[pyfunction]
pub(crate) fn _join_datasets(
    py: Python<'_>,
    parts: Vec<PathBuf>,
    out: PathBuf,
    link: bool,
    resume: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u64, u64, usize)> {
    let (transitions, bytes, repaired) =
        (AtomicU64::new(0), AtomicU64::new(0), Mutex::new(Vec::new()));
    let joined = run_in_background(
        py,
        |stop| {
            let transfer = if link { Transfer::Link } else { Transfer::Copy };
            let job = JoinJob { parts: &parts, out: &out, transfer, resume };
            let watch = ProgressWatch {
                transitions: &transitions,
                bytes: &bytes,
                repaired: &repaired,
                stop,
            };
            dataset::join(&job, &watch)
        },
        progress_callback(&transitions, &bytes, 0, progress.as_ref()),
    )?;
    let chunks = joined.map_err(Raised::raised)?.chunks.len();
    Ok((transitions.into_inner(), bytes.into_inner(), chunks))
}

/// A flaw: in which chunk, of which file, what it is, and whether it has been repaired.
type FlawEntry = (String, PathBuf, String, bool);

fn flaw_entry(flaw: Flaw, repaired: bool) -> FlawEntry {
    (flaw.chunk, flaw.path, keywords(&flaw.what), repaired)
}

/// Reads a data set, and computes it or what is broken again if asked to. Gives what is or was wrong, and what was not examined.
#[pyfunction]
pub(crate) fn _verify_dataset(
    py: Python<'_>,
    folder: PathBuf,
    replay: bool,
    repair: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<FlawEntry>, Vec<String>)> {
    let again = Execution::serial().threads(threads).map_err(Raised::raised)?;
    let how = VerifyOptions { replay: replay.then_some(&again), repair: repair.then_some(&again) };
    let (transitions, bytes, repaired) =
        (AtomicU64::new(0), AtomicU64::new(0), Mutex::new(Vec::new()));
    let checked = run_in_background(
        py,
        |stop| {
            let watch = ProgressWatch {
                transitions: &transitions,
                bytes: &bytes,
                repaired: &repaired,
                stop,
            };
            dataset::verify(&folder, how, &watch)
        },
        progress_callback(&transitions, &bytes, 0, progress.as_ref()),
    )?;
    let Verification { flaws, not_examined, .. } = checked.map_err(Raised::raised)?;
    let repaired = repaired.into_inner().unwrap_or_else(PoisonError::into_inner);
    let repaired = repaired.into_iter().map(|flaw| flaw_entry(flaw, true));
    let flaws = repaired.chain(flaws.into_iter().map(|flaw| flaw_entry(flaw, false))).collect();
    Ok((flaws, not_examined))
}

/// Tells how far it is, whenever that has changed.
fn progress_callback<'a>(
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
