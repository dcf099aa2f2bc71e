//! Long computations: parallel, interruptible, with progress.

mod progress;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use libration::ensemble::{EnsembleError, Execution, InstructionSet, has_global_threads};
use rayon::prelude::*;
use thiserror::Error;

pub use progress::{Progress, Silent};

/// The user stopped the work.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("interrupted")]
pub struct Interrupted;

/// The context of a long computation: instruction set, progress, and the flag that stops it.
#[derive(Clone, Copy)]
pub struct Work<'a> {
    /// The instruction set of ensembles; the widest of this processor if none.
    pub instructions: Option<InstructionSet>,
    progress: &'a dyn Progress,
    stop: &'a AtomicBool,
}

impl<'a> Work<'a> {
    /// Work that reports its progress to `progress` and stops soon after `stop` is set.
    pub fn new(progress: &'a dyn Progress, stop: &'a AtomicBool) -> Self {
        Work { instructions: None, progress, stop }
    }

    /// The same with an instruction set; none for the widest of this processor.
    #[must_use]
    pub fn on(self, instructions: Option<InstructionSet>) -> Self {
        Work { instructions, ..self }
    }

    /// The receiver of progress.
    pub fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    /// Execution on one thread with the instruction set of this work.
    ///
    /// # Errors
    /// If this processor lacks the instruction set.
    pub fn serial(&self) -> Result<Execution, EnsembleError> {
        Execution::serial().instructions(self.instructions.unwrap_or(InstructionSet::widest()))
    }

    /// Runs `job` on each item in parallel and returns the results in the order of the items.
    ///
    /// # Errors
    /// The first error of a job, or [`Interrupted`].
    pub fn sweep<T: Sync, R: Send, E: From<Interrupted> + Send>(
        &self,
        what: &str,
        items: &[T],
        job: impl Fn(&T) -> Result<R, E> + Sync,
    ) -> Result<Vec<R>, E> {
        self.progress.begin(what, items.len());
        let results: Vec<Mutex<Option<Result<R, E>>>> =
            items.iter().map(|_| Mutex::new(None)).collect();
        let failed = AtomicBool::new(false);
        in_parallel(items.len(), &|i| {
            if failed.load(Ordering::Relaxed) {
                return;
            }
            let result = self.check().map_err(E::from).and_then(|()| job(&items[i]));
            self.progress.advance();
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            *results[i].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        });
        self.progress.end();
        let done = |one: Mutex<_>| one.into_inner().unwrap_or_else(PoisonError::into_inner);
        results.into_iter().filter_map(done).collect()
    }

    /// Runs one part of the work alone.
    ///
    /// # Errors
    /// Those of the work, or [`Interrupted`].
    pub fn part<R, E: From<Interrupted>>(
        &self,
        what: &str,
        work: impl FnOnce() -> Result<R, E>,
    ) -> Result<R, E> {
        self.check()?;
        self.progress.begin(what, 1);
        let result = work();
        self.progress.end();
        result
    }

    /// Fails if the stop flag is set.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.stop.load(Ordering::Relaxed) { Err(Interrupted) } else { Ok(()) }
    }
}

/// Calls `run` for 0 to `count`, on all cores, or on this one where the system gives no threads. It is not generic because its machine
/// code is large.
fn in_parallel(count: usize, run: &(dyn Fn(usize) + Sync)) {
    match has_global_threads() {
        true => (0..count).into_par_iter().for_each(run),
        false => (0..count).for_each(run),
    }
}
