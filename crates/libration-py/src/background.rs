//! Long work without the interpreter's lock, interruptible by Ctrl-C.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Interval of checks for an interrupt and of progress reports.
const INTERVAL: Duration = Duration::from_millis(50);

/// Threads of this process for whatever divides its work. One that was forked has none of those that there were.
fn threads() -> PyResult<Arc<ThreadPool>> {
    static THREADS: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let mut threads = THREADS.lock().unwrap_or_else(PoisonError::into_inner);
    match &*threads {
        Some((process, pool)) if *process == std::process::id() => Ok(pool.clone()),
        _ => {
            let pool = ThreadPoolBuilder::new().build();
            let pool = pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
            Ok(threads.insert((std::process::id(), Arc::new(pool))).1.clone())
        }
    }
}

/// Runs work in a separate thread, which must end soon after the flag is set, and calls `report` periodically.
///
/// # Errors
/// Exceptions of `report` or of a signal handler; a `RuntimeError` if the work panicked.
pub(crate) fn run_in_background<R: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> R + Send,
    mut report: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<R> {
    let stop = AtomicBool::new(false);
    let threads = threads()?;
    thread::scope(|scope| {
        let waiting = thread::current();
        let worker = scope.spawn({
            let stop = &stop;
            move || {
                let result = threads.install(|| work(stop));
                waiting.unpark();
                result
            }
        });
        let mut raised = None;
        while !worker.is_finished() {
            py.detach(|| thread::park_timeout(INTERVAL));
            if raised.is_none()
                && let Err(error) = py.check_signals().and_then(|()| report(py))
            {
                stop.store(true, Ordering::Relaxed);
                raised = Some(error);
            }
        }
        let result = py.detach(|| worker.join());
        match (raised, result) {
            (Some(error), _) => Err(error),
            (None, Ok(result)) => report(py).map(|()| result),
            (None, Err(_)) => Err(PyRuntimeError::new_err("the engine failed; please report this")),
        }
    })
}
