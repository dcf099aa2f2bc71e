//! Controllers that measure the time between their runs.

use core::fmt;
use std::sync::Arc;

use crate::DiscreteController;

/// The controller for a length of the last period.
type ControllerOfLength = dyn Fn(f64) -> DiscreteController + Send + Sync;

/// A controller that uses the measured length of the last period, in s, in place of its nominal one.
#[derive(Clone)]
pub struct ClockedController {
    of_length: Arc<ControllerOfLength>,
    /// The nominal period, in s.
    period: f64,
}

impl fmt::Debug for ClockedController {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClockedController").field("period", &self.period).finish_non_exhaustive()
    }
}

impl ClockedController {
    /// The least measured length, as a part of the nominal period. Controllers limit it, since they divide by it.
    pub const LEAST: f64 = 0.1;

    /// The controller that `of_length` returns for the measured length of the last period in s, at least a tenth of the nominal
    /// `period`. All its controllers have equal sizes.
    pub fn new(
        period: f64,
        of_length: impl Fn(f64) -> DiscreteController + Send + Sync + 'static,
    ) -> Self {
        ClockedController { of_length: Arc::new(of_length), period }
    }

    /// The controller that has measured a period of so many seconds.
    pub fn at(&self, seconds: f64) -> DiscreteController {
        (self.of_length)(seconds.max(Self::LEAST * self.period))
    }

    /// The controller with all commands times `factor`.
    pub(crate) fn amplified(&self, factor: f64) -> Self {
        let own = self.of_length.clone();
        Self::new(self.period, move |seconds| own(seconds).amplified(factor))
    }
}
