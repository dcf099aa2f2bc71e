//! The laboratory of a study: configuration, threads and progress.

use std::sync::atomic::AtomicBool;

use libration::ensemble::{EnsembleError, Execution};
use libration_work::{Progress, Work};

use crate::{Config, Effort, StudyError};

/// The laboratory in which a study runs.
#[derive(Clone, Copy)]
pub struct Lab<'a> {
    /// The configuration.
    pub config: &'a Config,
    /// Effort of the study.
    pub effort: Effort,
    work: Work<'a>,
}

impl<'a> Lab<'a> {
    /// Returns a laboratory that reports to `progress`, and stops soon after `stop` is set.
    pub fn new(
        config: &'a Config,
        effort: Effort,
        progress: &'a dyn Progress,
        stop: &'a AtomicBool,
    ) -> Self {
        Lab { config, effort, work: Work::new(progress, stop).on(config.simd) }
    }

    /// Returns a serial execution with the instruction set of the configuration.
    ///
    /// # Errors
    /// If this processor lacks the instruction set.
    pub fn alone(&self) -> Result<Execution, EnsembleError> {
        self.work.serial()
    }

    /// Reports the start of the study `name`, the `number`-th of `of`.
    pub fn announce(&self, name: &str, number: usize, of: usize) {
        self.work.progress().study(name, number, of);
    }

    /// Runs `job` on every item in parallel, and returns the results in the order of the items.
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

    /// Runs a job with the whole machine.
    ///
    /// # Errors
    /// Errors of the job, or [`StudyError::Interrupted`].
    pub fn part<R>(
        &self,
        what: &str,
        work: impl FnOnce() -> Result<R, StudyError>,
    ) -> Result<R, StudyError> {
        self.work.part(what, work)
    }

    /// Fails if the run must stop.
    ///
    /// # Errors
    /// [`StudyError::Interrupted`].
    pub fn check(&self) -> Result<(), StudyError> {
        Ok(self.work.check()?)
    }
}
