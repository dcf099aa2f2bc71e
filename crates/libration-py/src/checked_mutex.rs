//! A mutex for Python threads.

use std::collections::VecDeque;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Sleep between two attempts to lock.
const NAP: Duration = Duration::from_micros(20);

/// A mutex that detects recursive locks and forks. Threads get it in the order in which they ask.
pub(crate) struct CheckedMutex<T> {
    inside: Mutex<T>,
    /// The thread that has it, and after how many forks it took it.
    owner: AtomicUsize,
    forks: AtomicU32,
    queue: Queue,
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
            queue: Queue::default(),
        }
    }

    /// Takes what is inside. Nobody waits for another thread with the interpreter's lock, which that may be waiting for.
    ///
    /// # Errors
    /// A `RuntimeError` where one would wait for oneself, as a handler of signals would that is called in the midst of a rollout, or for
    /// a thread that a fork has left behind; what a handler of signals raises meanwhile.
    pub(crate) fn lock(&self, py: Python<'_>) -> PyResult<CheckedGuard<'_, T>> {
        if self.queue.is_empty()
            && let Some(guard) = self.try_lock()
        {
            return Ok(guard);
        }
        // Who releases it and asks again would always be before those who sleep.
        let place = self.queue.enter();
        loop {
            if place.is_first()
                && let Some(guard) = self.try_lock()
            {
                return Ok(guard);
            }
            self.check_owner()?;
            py.detach(|| thread::sleep(NAP));
            py.check_signals()?;
        }
    }

    /// Takes it if nobody has it.
    fn try_lock(&self) -> Option<CheckedGuard<'_, T>> {
        let inside = match self.inside.try_lock() {
            Ok(inside) => inside,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return None,
        };
        self.forks.store(FORKS.load(Ordering::Relaxed), Ordering::Release);
        self.owner.store(this_thread(), Ordering::Release);
        Some(CheckedGuard { inside, owner: &self.owner })
    }

    /// Refuses to wait for this thread, or for one that this process does not have.
    fn check_owner(&self) -> PyResult<()> {
        let owner = self.owner.load(Ordering::Acquire);
        if owner == this_thread() {
            return Err(PyRuntimeError::new_err(
                "the object is in use by this thread; a signal handler or finaliser cannot use it",
            ));
        }
        if owner != NOBODY && self.forks.load(Ordering::Acquire) != FORKS.load(Ordering::Relaxed) {
            return Err(PyRuntimeError::new_err(
                "the object was in use by another thread when this process was forked; expected an object of this process",
            ));
        }
        Ok(())
    }
}

/// Waiting threads. It is used under the interpreter's lock only, so a fork never finds it locked.
#[derive(Default)]
struct Queue {
    waiting: Mutex<Waiting>,
    count: AtomicUsize,
}

#[derive(Default)]
struct Waiting {
    places: VecDeque<PlaceNumber>,
    /// Places that were ever given.
    given: u64,
}

#[derive(Clone, Copy, PartialEq)]
struct PlaceNumber {
    number: u64,
    thread: usize,
    forks: u32,
}

impl Queue {
    fn is_empty(&self) -> bool {
        self.count.load(Ordering::Acquire) == 0
    }

    /// Takes the last place, or the first where this thread waits already: it comes from a handler of signals or a finaliser, without
    /// which the other place does not go on.
    fn enter(&self) -> Place<'_> {
        let (thread, forks) = (this_thread(), FORKS.load(Ordering::Relaxed));
        let number = self.change(|Waiting { places, given }| {
            *given += 1;
            let place = PlaceNumber { number: *given, thread, forks };
            // A fork leaves the others behind.
            places.retain(|place| place.forks == forks);
            if places.iter().any(|place| place.thread == thread) {
                places.push_front(place);
            } else {
                places.push_back(place);
            }
            place
        });
        Place { queue: self, number }
    }

    fn change<R>(&self, change: impl FnOnce(&mut Waiting) -> R) -> R {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let result = change(&mut waiting);
        self.count.store(waiting.places.len(), Ordering::Release);
        result
    }
}

/// A place in a queue, which is left with this value.
struct Place<'a> {
    queue: &'a Queue,
    number: PlaceNumber,
}

impl Place<'_> {
    fn is_first(&self) -> bool {
        self.queue.change(|waiting| waiting.places.front() == Some(&self.number))
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.queue.change(|waiting| waiting.places.retain(|place| *place != self.number));
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
