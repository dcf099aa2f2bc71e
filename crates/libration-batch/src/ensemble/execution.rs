//! Where an ensemble runs.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::{EnsembleError, InstructionSet};

/// An instruction set and a number of threads. Results do not depend on either.
#[derive(Clone, Debug)]
pub struct Execution {
    instructions: InstructionSet,
    /// All threads but the one that calls; none where that is alone.
    pool: Option<Arc<ThreadPool>>,
    /// Steps of trajectories that are worth a thread, of the shortest there are.
    worth: u64,
}

/// Where the study `throughput` was written, to wake another core took as long as a million and a half of
/// the shortest steps.
const WORTH_A_THREAD: u64 = 1 << 21;

/// More threads than this are a slip of the hand: to start them takes longer than any work is worth.
pub const MOST_THREADS: usize = 1024;

impl Execution {
    /// The widest instruction set of this processor, on the thread that calls.
    pub fn serial() -> Self {
        let instructions = InstructionSet::widest();
        Execution { instructions, pool: None, worth: WORTH_A_THREAD }
    }

    /// The widest instruction set of this processor, on as many threads as it has cores.
    ///
    /// # Errors
    /// [`EnsembleError::Threads`].
    pub fn parallel() -> Result<Self, EnsembleError> {
        Execution::serial().threads(0)
    }

    /// Sets the number of threads (0: one per core).
    ///
    /// # Errors
    /// [`EnsembleError::Threads`] if the system does not give them.
    pub fn threads(self, threads: usize) -> Result<Self, EnsembleError> {
        let threads = if threads == 0 { cores() } else { threads };
        let build = |others| {
            let pool = ThreadPoolBuilder::new().num_threads(others).build();
            pool.map_err(|error| EnsembleError::Threads { threads, reason: error.to_string() })
        };
        if threads > MOST_THREADS {
            let reason = format!("there may be at most {MOST_THREADS}");
            return Err(EnsembleError::Threads { threads, reason });
        }
        let pool = if threads == 1 { None } else { Some(Arc::new(build(threads - 1)?)) };
        Ok(Execution { pool, ..self })
    }

    /// Sets the number of steps per thread. Tests with few steps lower it.
    #[doc(hidden)]
    pub fn worth(self, steps: u64) -> Self {
        Execution { worth: steps.max(1), ..self }
    }

    /// The number of threads for so many of the shortest steps.
    pub fn threads_for(&self, steps: u64) -> usize {
        let worth = usize::try_from(steps / self.worth).unwrap_or(usize::MAX).max(1);
        worth.min(self.thread_count())
    }

    /// Sets the instruction set.
    ///
    /// # Errors
    /// [`EnsembleError::Instructions`] if this processor lacks it.
    pub fn instructions(self, instructions: InstructionSet) -> Result<Self, EnsembleError> {
        if !instructions.is_available() {
            return Err(EnsembleError::Instructions { requested: instructions });
        }
        Ok(Execution { instructions, ..self })
    }

    /// The instruction set.
    pub fn instruction_set(&self) -> InstructionSet {
        self.instructions
    }

    /// The number of threads.
    pub fn thread_count(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| 1 + pool.current_num_threads())
    }

    /// Does `work` on every part and gives what comes out in the order of the parts.
    ///
    /// The thread that calls works too: where there is little to do, to wait for another to wake would take
    /// longer. With as many parts as threads each has the same one every time, whose memory is near to it;
    /// otherwise whoever is free takes the next.
    pub fn each<P: Send, R: Send>(&self, parts: Vec<P>, work: impl Fn(P) -> R + Sync) -> Vec<R> {
        self.each_dyn(parts, &work)
    }

    /// [`each`](Self::each), compiled once for all work on the same parts.
    fn each_dyn<P: Send, R: Send>(&self, parts: Vec<P>, work: &(dyn Fn(P) -> R + Sync)) -> Vec<R> {
        let Some(pool) = self.pool.as_ref().filter(|_| parts.len() > 1) else {
            return parts.into_iter().map(work).collect();
        };
        let mut results: Vec<Option<R>> = parts.iter().map(|_| None).collect();
        let pairs = parts.into_iter().zip(&mut results);
        let pairs: Vec<_> = pairs.map(|pair| Mutex::new(Some(pair))).collect();
        share_out(pool, pairs.len(), self.thread_count(), &|i| {
            let Some(pair) = pairs.get(i) else { return };
            if let Some((part, result)) = pair.lock().unwrap_or_else(PoisonError::into_inner).take()
            {
                *result = Some(work(part));
            }
        });
        drop(pairs);
        results.into_iter().flatten().collect()
    }
}

/// Runs the numbers from zero to `count` on the threads of `pool` and the one that calls. Nothing here is generic: what a scope is
/// compiled to is large, and there are hundreds of callers.
fn share_out(pool: &ThreadPool, count: usize, threads: usize, run: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    let drain = || {
        // Each number is taken by one thread.
        while let i = next.fetch_add(1, Ordering::Relaxed)
            && i < count
        {
            run(i);
        }
    };
    pool.in_place_scope(|scope| {
        if count == threads {
            scope.spawn_broadcast(|_, thread| run(1 + thread.index()));
            run(0);
        } else {
            for _ in 1..count.min(threads) {
                scope.spawn(|_| drain());
            }
            drain();
        }
    });
}

/// Whether the system gives threads for the parallel loops of `rayon` that have no pool of their own. Without this question, the first of
/// them panics where it gives none.
pub fn has_global_threads() -> bool {
    static HAS: OnceLock<bool> = OnceLock::new();
    *HAS.get_or_init(|| match ThreadPoolBuilder::new().build_global() {
        Ok(()) => true,
        // The only error without a cause is that there are threads already.
        Err(error) => std::error::Error::source(&error).is_none(),
    })
}

/// The cores that this process may use.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

impl Default for Execution {
    /// [`Execution::parallel`], or serial where the system gives no threads.
    fn default() -> Self {
        Execution::parallel().unwrap_or_else(|_| Execution::serial())
    }
}
