//! `libration rollout` and `libration verify`.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use libration::ensemble::Execution;
use libration::rl::EnvironmentError;
use libration_env::dataset;
use libration_env::dataset::{
    Dataset, DatasetError, EquationSource, Flaw, Monitor, VerifyOptions, WriteJob,
};
use libration_lab::ReportCheck;
use libration_settings::ConfigCommand;

use super::{config_file, verify_report};
use crate::args::{RolloutArgs, VerifyArgs};
use crate::error::{Failure, is_unusable};
use crate::{interrupt, progress, terminal};

/// Writes a data set, or resumes one.
pub(crate) fn run(args: &RolloutArgs, quiet: bool) -> Result<(), Failure> {
    if args.print_config {
        return Ok(terminal::print(dataset::DEFAULT)?);
    }
    let Some(out) = &args.out else {
        return Err(Failure::usage("--out is missing; expected a folder"));
    };
    let parse = |text: &str, name: &str| match &args.system {
        Some(system) => dataset::parse_of(EquationSource::File(system), &args.set, text, name),
        None => dataset::parse(text, name),
    };
    let dataset = match &args.config {
        Some(path) => config_file::read(path, |text, name| {
            parse(text, name).inspect(|_| {
                config_file::note_ignored_keys(text, ConfigCommand::ROLLOUT, quiet);
            })
        })?,
        None if args.system.is_none() => Dataset::default(),
        None => parse("", "defaults").map_err(|error| Failure::usage(error.message()))?,
    };
    let dataset = match args.transitions {
        Some(count) => dataset.transitions(count).map_err(|error| {
            Failure::usage(format!("{count} transitions (--transitions): {error}"))
        })?,
        None => dataset,
    };
    if let Some(caveat) = dataset.caveat().filter(|_| !quiet) {
        terminal::say(&format!("note: {caveat}"));
    }
    let job = WriteJob {
        dataset: &dataset,
        format: args.format,
        shard: args.shard,
        out,
        resume: args.resume,
        execution: threads(args.threads)?,
    };
    let watcher = Watcher::new(quiet, out, dataset.share(args.shard), interrupt::listen());
    let manifest = dataset::write(&job, &watcher);
    watcher.clear();
    let manifest = manifest.map_err(|error| match error {
        DatasetError::Interrupted => Failure::Interrupted(format!(
            "interrupted; `{}` holds {} transitions; help: continue with --resume",
            out.display(),
            watcher.transitions.load(Ordering::Relaxed)
        )),
        error => failed(error, out),
    })?;
    if !quiet {
        let (count, bytes) = watcher.totals();
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

/// Checks a data set; recomputes all of it with `--replay`, and broken chunks with `--repair`.
pub(crate) fn verify(args: &VerifyArgs, quiet: bool) -> Result<(), Failure> {
    if ReportCheck::is_report(&args.folder) {
        if args.replay || args.repair {
            return Err(Failure::usage(
                "--replay and --repair are for data sets; a report is always recomputed",
            ));
        }
        return verify_report::run(&args.folder, quiet);
    }
    let execution = if args.replay || args.repair { Some(threads(args.threads)?) } else { None };
    let how = VerifyOptions {
        replay: execution.as_ref().filter(|_| args.replay),
        repair: execution.as_ref().filter(|_| args.repair),
    };
    let watcher = Watcher::new(quiet, &args.folder, 0, interrupt::listen());
    let checked = dataset::verify(&args.folder, how, &watcher);
    watcher.clear();
    let (manifest, flaws) = checked.map_err(|error| match error {
        DatasetError::Interrupted => Failure::Interrupted("interrupted".to_owned()),
        error => failed(error, &args.folder),
    })?;
    for flaw in &flaws {
        terminal::error(&shown(flaw, &args.folder));
    }
    if !flaws.is_empty() {
        if !args.repair && flaws.iter().any(|flaw| flaw.broken) {
            let folder = args.folder.to_string_lossy();
            let folder = shlex::try_quote(&folder).unwrap_or_default();
            terminal::say(&format!(
                "help: `libration verify --repair {folder}` recomputes broken chunks and replaces them"
            ));
        }
        return Err(Failure::Disagreement);
    }
    if !quiet {
        let what = if args.replay {
            "as the manifest and the settings say"
        } else {
            "as the manifest says"
        };
        terminal::print(&format!(
            "{} chunks, {} files, {:.3} GB: all {what}\n",
            manifest.chunks.len(),
            manifest.chunks.iter().map(|chunk| chunk.files.len()).sum::<usize>(),
            manifest.bytes() as f64 / 1e9
        ))?;
    }
    Ok(())
}

/// Returns a flaw as a line: chunk, file and defect.
fn shown(flaw: &Flaw, folder: &Path) -> String {
    let whose = match &*flaw.chunk {
        "" => String::new(),
        chunk => format!("chunk {chunk}: "),
    };
    format!("{whose}{} {}", folder.join(&flaw.path).display(), flaw.what)
}

fn threads(threads: usize) -> Result<Execution, Failure> {
    Execution::serial().threads(threads).map_err(|error| Failure::ensemble(&error))
}

/// Converts an error: wrong input is known before any work, all other errors occur during the run.
fn failed(error: DatasetError, folder: &Path) -> Failure {
    use libration_env::dataset::DataError;
    if let Some(shortage) = error.missing_memory() {
        return Failure::out_of_memory(shortage, &error);
    }
    match error {
        error if is_unusable(&error, folder) => Failure::usage(error),
        DatasetError::Environment(EnvironmentError::Ensemble(error)) => Failure::ensemble(&error),
        DatasetError::Data(DataError::Io { .. })
        | DatasetError::Table(_)
        | DatasetError::Unrepairable { .. } => Failure::run(error),
        error => Failure::usage(error),
    }
}

/// Progress and rate of a run.
struct Watcher {
    quiet: bool,
    folder: PathBuf,
    bar: Option<ProgressBar>,
    transitions: AtomicU64,
    bytes: AtomicU64,
    /// Bytes of an earlier run.
    before: AtomicU64,
    began: Instant,
    stop: &'static AtomicBool,
}

impl Watcher {
    fn new(quiet: bool, folder: &Path, transitions: u64, stop: &'static AtomicBool) -> Self {
        let bar = (!quiet && progress::has_bars()).then(|| {
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
        let (folder, began) = (folder.to_owned(), Instant::now());
        Watcher { quiet, folder, bar, transitions, bytes, before, began, stop }
    }

    /// Returns the transitions and bytes so far.
    fn totals(&self) -> (u64, u64) {
        (self.transitions.load(Ordering::Relaxed), self.bytes.load(Ordering::Relaxed))
    }

    fn clear(&self) {
        self.bar.iter().for_each(|bar| bar.finish_and_clear());
    }
}

impl Monitor for Watcher {
    fn on_present(&self, transitions: u64, bytes: u64) {
        self.transitions.fetch_add(transitions, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        self.before.fetch_add(bytes, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.inc(transitions);
            // The rate excludes the transitions of an earlier run.
            bar.reset_eta();
        }
    }

    fn on_written(&self, transitions: u64, bytes: u64) {
        self.transitions.fetch_add(transitions, Ordering::Relaxed);
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.inc(transitions);
            let bytes = self.totals().1 as f64 / 1e9;
            let before = self.before.load(Ordering::Relaxed) as f64 / 1e9;
            let rate = (bytes - before) / self.began.elapsed().as_secs_f64().max(1e-3);
            bar.set_message(format!("{bytes:.2} GB, {rate:.2} GB/s"));
        }
    }

    fn on_verified(&self, bytes: u64, of: u64) {
        if let Some(bar) = &self.bar {
            let [bytes, of] = [bytes, of].map(|bytes| bytes as f64 / 1e9);
            let rate = bytes / self.began.elapsed().as_secs_f64().max(1e-3);
            let left = Duration::try_from_secs_f64((of - bytes) / rate.max(1e-9));
            let left = HumanDuration(left.unwrap_or_default());
            bar.set_message(format!(
                "{bytes:.2} of {of:.2} GB checked, {rate:.2} GB/s, {left:#} left"
            ));
        }
    }

    fn on_repaired(&self, flaw: &Flaw) {
        if !self.quiet {
            let print = || terminal::say(&format!("repaired: {}", shown(flaw, &self.folder)));
            self.bar.as_ref().map_or_else(print, |bar| bar.suspend(print));
        }
    }

    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
