//! The same work on several threads at once.

use libration::ensemble::EnsembleError;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads that wait for work: to start one for each turn would take longer than the turn.
pub(crate) struct Team {
    /// None where there is one thread.
    pool: Option<ThreadPool>,
}

impl Team {
    /// So many threads, of which one is that of the caller.
    ///
    /// # Errors
    /// If the system does not give them.
    pub(crate) fn new(threads: usize) -> Result<Self, EnsembleError> {
        if threads == 1 {
            return Ok(Team { pool: None });
        }
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        match pool {
            Ok(pool) => Ok(Team { pool: Some(pool) }),
            Err(error) => Err(EnsembleError::Threads { threads, reason: error.to_string() }),
        }
    }

    /// Runs `work` on every part, of which there is one for each thread, and waits for all.
    pub(crate) fn each<P: Send>(&self, parts: Vec<P>, work: impl Fn(P) + Sync + Send) {
        match &self.pool {
            None => parts.into_iter().for_each(work),
            Some(pool) => pool.install(|| parts.into_par_iter().with_max_len(1).for_each(work)),
        }
    }
}
