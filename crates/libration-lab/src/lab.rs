//! What a study may use: the configuration, the cores, and a way to say how far it is.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use libration::ensemble::{EnsembleError, Execution, InstructionSet};
use rayon::prelude::*;

use crate::study::StudyError;
use crate::{Config, Effort};

/// Told how far the work is. The laboratory itself knows no terminal.
pub trait Progress: Sync {
    /// The study `name` begins, the `number`-th of `of`.
    fn study(&self, name: &str, number: usize, of: usize) {
        let _ = (name, number, of);
    }
    /// `what` begins; it has `total` parts of about equal size.
    fn begin(&self, what: &str, total: usize);
    /// One part is done.
    fn advance(&self);
    /// All that began is done.
    fn end(&self);
}

/// Tells nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: usize) {}
    fn advance(&self) {}
    fn end(&self) {}
}

/// The laboratory in which a study runs.
#[derive(Clone, Copy)]
pub struct Lab<'a> {
    /// What is studied.
    pub config: &'a Config,
    /// How much work the study may take.
    pub effort: Effort,
    progress: &'a dyn Progress,
    stop: &'a AtomicBool,
}

impl<'a> Lab<'a> {
    /// A laboratory that tells `progress` how far it is and stops soon after `stop` is set.
    pub fn new(
        config: &'a Config,
        effort: Effort,
        progress: &'a dyn Progress,
        stop: &'a AtomicBool,
    ) -> Self {
        Lab { config, effort, progress, stop }
    }

    /// One thread, on the instruction set of the configuration.
    ///
    /// # Errors
    /// If this processor lacks it.
    pub fn alone(&self) -> Result<Execution, EnsembleError> {
        let set = self.config.simd.unwrap_or(InstructionSet::widest());
        Execution::serial().instructions(set)
    }

    /// Tells that the study `name` begins, the `number`-th of `of`.
    pub(crate) fn announce(&self, name: &str, number: usize, of: usize) {
        self.progress.study(name, number, of);
    }

    /// Runs `job` on every item, in parallel, and gives the results in the order of the items.
    ///
    /// # Errors
    /// The first error of a job, or [`StudyError::Interrupted`].
    pub fn sweep<T: Sync, R: Send>(
        &self,
        what: &str,
        items: &[T],
        job: impl Fn(&T) -> Result<R, StudyError> + Sync,
    ) -> Result<Vec<R>, StudyError> {
        self.progress.begin(what, items.len());
        let results: Vec<Mutex<Option<Result<R, StudyError>>>> =
            items.iter().map(|_| Mutex::new(None)).collect();
        let failed = AtomicBool::new(false);
        in_parallel(items.len(), &|i| {
            if failed.load(Ordering::Relaxed) {
                return;
            }
            let result = self.check().and_then(|()| job(&items[i]));
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
    /// Those of the work, or [`StudyError::Interrupted`].
    pub fn part<R>(
        &self,
        what: &str,
        work: impl FnOnce() -> Result<R, StudyError>,
    ) -> Result<R, StudyError> {
        self.check()?;
        self.progress.begin(what, 1);
        let result = work();
        self.progress.end();
        result
    }

    /// Fails if the run is to stop.
    ///
    /// # Errors
    /// [`StudyError::Interrupted`].
    pub fn check(&self) -> Result<(), StudyError> {
        if self.stop.load(Ordering::Relaxed) { Err(StudyError::Interrupted) } else { Ok(()) }
    }
}

/// Runs the numbers from zero to `count`, on all cores. Nothing here is generic: what it is compiled to is large, and there are many
/// sweeps.
fn in_parallel(count: usize, run: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(run);
}
