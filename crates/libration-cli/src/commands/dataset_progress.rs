//! Progress of data sets, and their errors as failures.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use libration::rl::EnvironmentError;
use libration_env::dataset::{DataError, DatasetError, Flaw, Monitor};
use libration_report::printable::printable;

use crate::error::{Failure, is_unusable};
use crate::{interrupt, progress, terminal};

/// Returns a flaw as a line: chunk, file and defect.
pub(super) fn shown(flaw: &Flaw, folder: &Path) -> String {
    let whose = match &*flaw.chunk {
        "" => String::new(),
        chunk => format!("chunk {chunk}: "),
    };
    let path = folder.join(&flaw.path).display().to_string();
    printable(&format!("{whose}{path} {}", flaw.what)).into_owned()
}

/// Converts an error: wrong input is known before any work, all other errors occur during the run.
pub(super) fn failed(error: DatasetError, folder: &Path) -> Failure {
    if let Some(shortage) = error.missing_memory() {
        return Failure::out_of_memory(shortage, &error);
    }
    match error {
        error if is_unusable(&error, folder) => Failure::usage(error),
        DatasetError::Environment(EnvironmentError::Ensemble(error)) => Failure::ensemble(&error),
        DatasetError::Data(DataError::Io { .. } | DataError::Damaged { .. })
        | DatasetError::Table(_)
        | DatasetError::Unrepairable { .. } => Failure::run(error),
        error => Failure::usage(error),
    }
}

/// Progress and rate of a run.
pub(super) struct Watcher {
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
    /// A watcher of `transitions` transitions (0: nobody knows how many), with a bar on a terminal.
    pub(super) fn new(quiet: bool, folder: &Path, transitions: u64) -> Self {
        let stop = interrupt::listen();
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
    pub(super) fn totals(&self) -> (u64, u64) {
        (self.transitions.load(Ordering::Relaxed), self.bytes.load(Ordering::Relaxed))
    }

    /// Returns the seconds since the beginning.
    pub(super) fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// Removes the bar.
    pub(super) fn clear(&self) {
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

    fn on_recomputed(&self) {
        if let Some(bar) = &self.bar {
            bar.set_message("computing the state after the last chunk");
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
