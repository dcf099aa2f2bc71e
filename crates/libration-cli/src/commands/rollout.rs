//! `libration rollout` and `libration verify`.

use std::io::{IsTerminal, stderr};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use libration::ensemble::Execution;
use libration_lab::dataset::{self, Dataset, DatasetError, Job, Watch};

use super::config_file;
use crate::args::{RolloutArgs, VerifyArgs};
use crate::error::Failure;
use crate::{interrupt, terminal};

/// Writes a data set, or goes on with one.
pub(crate) fn run(args: &RolloutArgs, quiet: bool) -> Result<(), Failure> {
    if args.print_config {
        return Ok(terminal::print(dataset::DEFAULT)?);
    }
    let Some(out) = &args.out else {
        return Err(Failure::usage("--out is missing; it must be a folder"));
    };
    let dataset = match &args.config {
        Some(path) => config_file::read(path, dataset::parse)?,
        None => Dataset::default(),
    };
    let dataset = match args.transitions {
        Some(count) => dataset.transitions(count).map_err(|error| {
            Failure::usage(format!("{count} transitions (--transitions): {error}"))
        })?,
        None => dataset,
    };
    let job = Job {
        dataset: &dataset,
        format: args.format,
        shard: args.shard,
        out,
        resume: args.resume,
        execution: threads(args.threads)?,
    };
    let watcher = Watcher::new(quiet, dataset.share(args.shard), interrupt::listen()?);
    let manifest = dataset::write(&job, &watcher);
    watcher.clear();
    let manifest = manifest.map_err(|error| match error {
        DatasetError::Interrupted => Failure::Interrupted(format!(
            "interrupted; `{}` holds {} transitions, and --resume goes on",
            out.display(),
            watcher.transitions.load(Ordering::Relaxed)
        )),
        error => failed(error),
    })?;
    if !quiet {
        let (count, bytes) = watcher.told();
        let seconds = watcher.began.elapsed().as_secs_f64();
        terminal::print(&format!(
            "{count} transitions in {} chunks, {:.3} GB, after {seconds:.1} s of this run: {}\n",
            manifest.chunks.len(),
            bytes as f64 / 1e9,
            out.display()
        ))?;
    }
    Ok(())
}

/// Reads a data set, and computes it again if asked to.
pub(crate) fn verify(args: &VerifyArgs, quiet: bool) -> Result<(), Failure> {
    let again = if args.replay { Some(threads(args.threads)?) } else { None };
    let watcher = Watcher::new(quiet, 0, interrupt::listen()?);
    let checked = dataset::check(&args.folder, again.as_ref(), &watcher);
    watcher.clear();
    let (manifest, flaws) = checked.map_err(|error| match error {
        DatasetError::Interrupted => Failure::Interrupted("interrupted".to_owned()),
        error => failed(error),
    })?;
    for flaw in &flaws {
        let path = args.folder.join(&flaw.path);
        let whose = match &*flaw.chunk {
            "" => String::new(),
            chunk => format!("chunk {chunk}: "),
        };
        terminal::error(&format!("{whose}{} {}", path.display(), flaw.what));
    }
    if !flaws.is_empty() {
        return Err(Failure::Disagreement);
    }
    if !quiet {
        let what = if args.replay {
            "as the manifest and the settings say"
        } else {
            "as the manifest says"
        };
        let (files, bytes) = (
            manifest.chunks.iter().map(|chunk| chunk.files.len()).sum::<usize>(),
            watcher.told().1,
        );
        terminal::print(&format!(
            "{} chunks, {files} files, {:.3} GB: all {what}\n",
            manifest.chunks.len(),
            bytes as f64 / 1e9
        ))?;
    }
    Ok(())
}

fn threads(threads: usize) -> Result<Execution, Failure> {
    Execution::serial().threads(threads).map_err(Failure::usage)
}

/// What is wrong with the input is known before any work; all else went wrong meanwhile.
fn failed(error: DatasetError) -> Failure {
    use libration_lab::dataset::DataError;
    match error {
        DatasetError::Data(DataError::Io { .. }) | DatasetError::Table(_) => Failure::run(error),
        error => Failure::usage(error),
    }
}

/// What is done so far, and how fast.
struct Watcher {
    bar: Option<ProgressBar>,
    transitions: AtomicU64,
    bytes: AtomicU64,
    /// Of those what was there before.
    before: AtomicU64,
    began: Instant,
    stop: &'static AtomicBool,
}

impl Watcher {
    fn new(quiet: bool, transitions: u64, stop: &'static AtomicBool) -> Self {
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let bar = (!quiet && stderr().is_terminal() && !dumb).then(|| {
            let template = if transitions == 0 {
                "{spinner} {msg}"
            } else {
                "{bar:20} {percent} %  {human_pos} transitions, {per_sec}  {eta} left  {msg}"
            };
            let style = ProgressStyle::with_template(template);
            let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::new(transitions).with_style(style.progress_chars("━╸─"));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let zero = || AtomicU64::new(0);
        let (transitions, bytes, before) = (zero(), zero(), zero());
        Watcher { bar, transitions, bytes, before, began: Instant::now(), stop }
    }

    fn told(&self) -> (u64, u64) {
        (self.transitions.load(Ordering::Relaxed), self.bytes.load(Ordering::Relaxed))
    }

    fn clear(&self) {
        self.bar.iter().for_each(|bar| bar.finish_and_clear());
    }
}

impl Watch for Watcher {
    fn there(&self, transitions: u64, bytes: u64) {
        self.transitions.fetch_add(transitions, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        self.before.fetch_add(bytes, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.inc(transitions);
            // Neither rate nor time left follow from what was there.
            bar.reset_eta();
        }
    }

    fn done(&self, transitions: u64, bytes: u64) {
        self.transitions.fetch_add(transitions, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.inc(transitions);
            let bytes = self.told().1 as f64 / 1e9;
            let before = self.before.load(Ordering::Relaxed) as f64 / 1e9;
            let rate = (bytes - before) / self.began.elapsed().as_secs_f64().max(1e-3);
            bar.set_message(format!("{bytes:.2} GB, {rate:.2} GB/s"));
        }
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
