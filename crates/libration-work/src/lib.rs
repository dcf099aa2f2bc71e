//! Long work: divided among cores, with progress, until it is done or stopped.

mod progress;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use libration::ensemble::{EnsembleError, Execution, InstructionSet};
use rayon::prelude::*;
use thiserror::Error;

pub use progress::{Progress, Silent};

/// The user stopped the work.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("interrupted")]
pub struct Interrupted;

/// The cores, and how work reports progress and learns that it is to stop.
#[derive(Clone, Copy)]
pub struct Work<'a> {
    /// The instruction set of ensembles; the widest that there is if none.
    pub instructions: Option<InstructionSet>,
    progress: &'a dyn Progress,
    stop: &'a AtomicBool,
}

impl<'a> Work<'a> {
    /// Work that reports its progress to `progress` and stops soon after `stop` is set.
    pub fn new(progress: &'a dyn Progress, stop: &'a AtomicBool) -> Self {
        Work { instructions: None, progress, stop }
    }

    /// The same on an instruction set; on the widest that there is if none.
    #[must_use]
    pub fn on(self, instructions: Option<InstructionSet>) -> Self {
        Work { instructions, ..self }
    }

    /// Where progress is reported to.
    pub fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    /// One thread, on the instruction set of this work.
    ///
    /// # Errors
    /// If this processor lacks it.
    pub fn serial(&self) -> Result<Execution, EnsembleError> {
        Execution::serial().instructions(self.instructions.unwrap_or(InstructionSet::widest()))
    }

    /// Runs `job` on every item, in parallel, and gives the results in the order of the items.
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

    /// Does one piece of work that has all of the machine to itself.
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

    /// Fails if the work is to stop.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.stop.load(Ordering::Relaxed) { Err(Interrupted) } else { Ok(()) }
    }
}

/// Runs the numbers from zero to `count`, on all cores. Nothing here is generic: what it is compiled to is large, and there are many
/// sweeps.
fn in_parallel(count: usize, run: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(run);
}
