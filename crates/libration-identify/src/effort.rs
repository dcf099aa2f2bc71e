//! The work that a search may spend, and the flag that stops it.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use libration_work::Work;

/// Steps of a filter that a search may take by default: some seconds.
const DEFAULT_STEPS: u64 = 5_000_000;
/// Fewest and most evaluations of the likelihood by default.
const DEFAULT_EVALUATIONS: (u64, u64) = (1000, 20_000);

/// The work that a search may spend: steps of a filter, of which each response takes one, so that results do not depend on the speed of a
/// machine.
#[derive(Clone)]
pub(crate) struct Effort<'w> {
    work: Work<'w>,
    spent: Arc<AtomicU64>,
    most: u64,
}

impl<'w> Effort<'w> {
    /// A search without a bound, which hears the stop flag.
    pub(crate) fn unlimited(work: Work<'w>) -> Self {
        Effort { work, spent: Arc::default(), most: u64::MAX }
    }

    /// A search of `evaluations` of a likelihood of `responses`.
    pub(crate) fn limited(work: Work<'w>, evaluations: u64, responses: usize) -> Self {
        let most = evaluations.saturating_mul(responses.max(1) as u64);
        Effort { work, spent: Arc::default(), most }
    }

    /// The same effort for another search, `times` as large.
    pub(crate) fn renewed(&self, times: u64) -> Self {
        Effort { work: self.work, spent: Arc::default(), most: self.most.saturating_mul(times) }
    }

    /// The same without a bound.
    pub(crate) fn unbounded(&self) -> Self {
        Effort::unlimited(self.work)
    }

    /// Whether another evaluation of a likelihood of `responses` is allowed, which is counted.
    pub(crate) fn spend(&self, responses: usize) -> bool {
        if self.work.check().is_err() {
            return false;
        }
        let spent = self.spent.fetch_add(responses as u64, Ordering::Relaxed);
        spent + responses as u64 <= self.most
    }

    /// Whether an evaluation was refused for want of work.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.spent.load(Ordering::Relaxed) > self.most
    }
}

impl fmt::Debug for Effort<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Effort({:?} of {})", self.spent, self.most)
    }
}

/// The default number of evaluations of a likelihood of `responses`.
pub(crate) fn default_evaluations(responses: usize) -> u64 {
    let (fewest, most) = DEFAULT_EVALUATIONS;
    (DEFAULT_STEPS / responses.max(1) as u64).clamp(fewest, most)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use libration_work::Silent;

    use super::*;

    #[test]
    fn a_search_ends_after_its_evaluations_and_at_once_when_it_is_stopped() {
        let stop = AtomicBool::new(false);
        let work = Work::new(&Silent, &stop);
        let effort = Effort::limited(work, 3, 100);
        // A clone shares the account.
        assert!((0..3).all(|_| effort.clone().spend(100)) && !effort.is_exhausted());
        assert!(!effort.spend(1) && effort.is_exhausted());
        let other = Effort::unlimited(work);
        assert!(other.spend(100));
        stop.store(true, Ordering::Relaxed);
        assert!(!other.spend(100) && !other.is_exhausted());
    }

    #[test]
    fn long_recordings_have_fewer_evaluations_and_none_has_none() {
        let counts = [30, 1000, 6461, 10_000, 1_000_000].map(default_evaluations);
        assert_eq!(counts, [20_000, 5000, 1000, 1000, 1000]);
    }
}
