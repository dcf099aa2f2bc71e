//! Where an ensemble runs.

use std::sync::{Arc, Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::{EnsembleError, InstructionSet};

/// An instruction set and a number of threads. Results do not depend on either.
#[derive(Clone, Debug)]
pub struct Execution {
    instructions: InstructionSet,
    /// None where there is one thread.
    pool: Option<Arc<ThreadPool>>,
}

impl Execution {
    /// The widest instruction set of this processor, on the thread that calls.
    pub fn serial() -> Self {
        Execution { instructions: InstructionSet::widest(), pool: None }
    }

    /// The widest instruction set of this processor, on as many threads as it has cores.
    ///
    /// # Errors
    /// [`EnsembleError::Threads`].
    pub fn parallel() -> Result<Self, EnsembleError> {
        Execution::serial().threads(0)
    }

    /// This, on so many threads; 0 stands for as many as there are cores.
    ///
    /// # Errors
    /// [`EnsembleError::Threads`] if the system does not give them.
    pub fn threads(self, threads: usize) -> Result<Self, EnsembleError> {
        let build = |threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            pool.map_err(|error| EnsembleError::Threads { threads, reason: error.to_string() })
        };
        let pool = if threads == 1 { None } else { Some(Arc::new(build(threads)?)) };
        Ok(Execution { pool, ..self })
    }

    /// This, on that instruction set.
    ///
    /// # Errors
    /// [`EnsembleError::Instructions`] if this processor lacks it.
    pub fn instructions(self, instructions: InstructionSet) -> Result<Self, EnsembleError> {
        if !instructions.is_available() {
            return Err(EnsembleError::Instructions { asked: instructions });
        }
        Ok(Execution { instructions, ..self })
    }

    /// The instruction set.
    pub fn instruction_set(&self) -> InstructionSet {
        self.instructions
    }

    /// The number of threads.
    pub fn thread_count(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// Gives each share to a thread of its own, the same one each time; at most one per thread.
    pub(super) fn each<P: Send, R: Send>(
        &self,
        parts: Vec<P>,
        work: impl Fn(P) -> R + Sync,
    ) -> Vec<R> {
        match &self.pool {
            Some(pool) if parts.len() > 1 => {
                let parts: Vec<_> = parts.into_iter().map(|part| Mutex::new(Some(part))).collect();
                let take =
                    |i: usize| parts.get(i)?.lock().unwrap_or_else(PoisonError::into_inner).take();
                let results = pool.broadcast(|thread| take(thread.index()).map(&work));
                results.into_iter().flatten().collect()
            }
            _ => parts.into_iter().map(work).collect(),
        }
    }
}

impl Default for Execution {
    /// [`Execution::parallel`], or serial where the system gives no threads.
    fn default() -> Self {
        Execution::parallel().unwrap_or_else(|_| Execution::serial())
    }
}
