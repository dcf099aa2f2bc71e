//! Work that is divided among threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// The results of `work` for each number below `count`, in order, on at most `threads` threads.
pub fn run_on_threads<R: Send>(
    threads: usize,
    count: usize,
    work: impl Fn(usize) -> R + Sync,
) -> Vec<R> {
    if threads < 2 || count < 2 {
        return (0..count).map(work).collect();
    }
    let results: Vec<Mutex<Option<R>>> = (0..count).map(|_| Mutex::new(None)).collect();
    let next = AtomicUsize::new(0);
    let drain = || {
        while let i = next.fetch_add(1, Ordering::Relaxed)
            && let Some(result) = results.get(i)
        {
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(work(i));
        }
    };
    thread::scope(|scope| {
        // Where the system gives no more threads, the ones at hand do the work.
        let start = |_| thread::Builder::new().spawn_scoped(scope, drain).is_ok();
        (1..threads.min(count)).all(start);
        drain();
    });
    let taken =
        |result: Mutex<Option<R>>| result.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().filter_map(taken).collect()
}
