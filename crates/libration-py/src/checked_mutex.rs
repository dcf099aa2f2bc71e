//! A mutex for Python threads.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Sleep between two attempts to lock.
const NAP: Duration = Duration::from_micros(20);

/// A mutex that detects recursive locks and forks.
pub(crate) struct CheckedMutex<T> {
    inside: Mutex<T>,
    /// The thread that has it, and after how many forks it took it.
    owner: AtomicUsize,
    forks: AtomicU32,
}

/// Guard of a [`CheckedMutex`].
pub(crate) struct CheckedGuard<'a, T> {
    inside: MutexGuard<'a, T>,
    owner: &'a AtomicUsize,
}

impl<T> CheckedMutex<T> {
    pub(crate) fn new(inside: T) -> Self {
        CheckedMutex {
            inside: Mutex::new(inside),
            owner: AtomicUsize::new(NOBODY),
            forks: AtomicU32::new(0),
        }
    }

    /// Takes what is inside. Nobody waits for another thread with the interpreter's lock, which that may be waiting for.
    ///
    /// # Errors
    /// A `RuntimeError` where one would wait for oneself, as a handler of signals would that is called in the midst of a rollout, or for
    /// a thread that a fork has left behind; what a handler of signals raises meanwhile.
    pub(crate) fn lock(&self, py: Python<'_>) -> PyResult<CheckedGuard<'_, T>> {
        loop {
            let inside = match self.inside.try_lock() {
                Ok(inside) => inside,
                Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
                Err(TryLockError::WouldBlock) => {
                    let owner = self.owner.load(Ordering::Acquire);
                    if owner == this_thread() {
                        return Err(PyRuntimeError::new_err(
                            "the object is in use by this thread; a signal handler or finaliser cannot use it",
                        ));
                    }
                    let here = self.forks.load(Ordering::Acquire) == FORKS.load(Ordering::Relaxed);
                    if owner != NOBODY && !here {
                        return Err(PyRuntimeError::new_err(
                            "the object was in use by another thread when this process was forked; expected an object of this process",
                        ));
                    }
                    py.detach(|| thread::sleep(NAP));
                    py.check_signals()?;
                    continue;
                }
            };
            self.forks.store(FORKS.load(Ordering::Relaxed), Ordering::Release);
            self.owner.store(this_thread(), Ordering::Release);
            return Ok(CheckedGuard { inside, owner: &self.owner });
        }
    }
}

const NOBODY: usize = 0;

/// How many forks lie between the process that imported the package and this one. Whoever asked the system which process this is would pay for
/// that in every step.
static FORKS: AtomicU32 = AtomicU32::new(0);

/// Records a fork; Python calls it in the child process.
#[pyfunction]
pub(crate) fn _forked() {
    FORKS.fetch_add(1, Ordering::Relaxed);
}

/// Returns a number that identifies the current thread.
fn this_thread() -> usize {
    thread_local!(static MARK: u8 = const { 0 });
    MARK.with(|mark| std::ptr::from_ref(mark) as usize)
}

impl<T> Deref for CheckedGuard<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.inside
    }
}

impl<T> DerefMut for CheckedGuard<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.inside
    }
}

impl<T> Drop for CheckedGuard<'_, T> {
    fn drop(&mut self) {
        self.owner.store(NOBODY, Ordering::Release);
    }
}
