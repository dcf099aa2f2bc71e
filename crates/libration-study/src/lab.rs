//! What a study may use: the configuration, the cores, and a way to report progress.

use std::sync::atomic::AtomicBool;

use libration::ensemble::{EnsembleError, Execution};
use libration_work::{Progress, Work};

use crate::{Config, Effort, StudyError};

/// The laboratory in which a study runs.
#[derive(Clone, Copy)]
pub struct Lab<'a> {
    /// What is studied.
    pub config: &'a Config,
    /// How much work the study may take.
    pub effort: Effort,
    work: Work<'a>,
}

impl<'a> Lab<'a> {
    /// A laboratory that reports its progress to `progress` and stops soon after `stop` is set.
    pub fn new(
        config: &'a Config,
        effort: Effort,
        progress: &'a dyn Progress,
        stop: &'a AtomicBool,
    ) -> Self {
        Lab { config, effort, work: Work::new(progress, stop).on(config.simd) }
    }

    /// One thread, on the instruction set of the configuration.
    ///
    /// # Errors
    /// If this processor lacks it.
    pub fn alone(&self) -> Result<Execution, EnsembleError> {
        self.work.serial()
    }

    /// Reports that the study `name` begins, the `number`-th of `of`.
    pub fn announce(&self, name: &str, number: usize, of: usize) {
        self.work.progress().study(name, number, of);
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
        self.work.sweep(what, items, job)
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
        self.work.part(what, work)
    }

    /// Fails if the run is to stop.
    ///
    /// # Errors
    /// [`StudyError::Interrupted`].
    pub fn check(&self) -> Result<(), StudyError> {
        Ok(self.work.check()?)
    }
}
