//! Environments as Python steps them.

use libration::ensemble::Execution;
use libration::rl::{EnvironmentError, Plan};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::acts::Told;
use crate::array::{Array, Number, fresh, room};
use crate::error::{Raised, refused};
use crate::guarded::{Entered, Guarded};
use crate::held::{Held, Table, with_table};
use crate::rollout::Memory;
use crate::settings::Settings;
use crate::step::{self, Books, Step};

/// Environments that are stepped together, without anything of Gymnasium.
///
/// The classes of `libration` are made of it.
#[pyclass(subclass, frozen, module = "libration._native")]
pub(crate) struct Batch {
    inner: Guarded<Option<Inner>>,
}

/// What there is until it is closed.
struct Inner {
    held: Held,
    books: Books,
    /// The process that has its threads.
    process: u32,
    threads: usize,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (*args, **kwargs))]
    #[allow(unused_variables, reason = "a class of Python's takes them, and sets up what is here")]
    fn new(args: &Bound<'_, PyTuple>, kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Batch { inner: Guarded::new(None) }
    }

    /// Makes environments; `buffers` is after how many steps an array is used again, or 0 for new arrays in every step.
    fn _set_up(&self, py: Python<'_>, settings: Settings, buffers: usize) -> PyResult<()> {
        let (recipe, execution) = (settings.recipe()?, settings.execution()?);
        let len = settings.num_envs;
        let held = Held::new(&recipe, settings.single()?, len, &execution);
        *self.inner.enter(py)? = Some(Inner {
            held: held.map_err(Raised::raised)?,
            books: Books::new(&recipe, len, buffers),
            process: std::process::id(),
            threads: execution.thread_count(),
        });
        Ok(())
    }

    /// Takes one action of each environment: an array of shape `(num_envs, 1)` or `(num_envs,)`, in the unit of an acceleration.
    ///
    /// Gives what is seen then `(num_envs, n)`, rewards, whether episodes terminated and whether they were truncated `(num_envs,)`, and a
    /// dictionary: of episodes that ended in it (`final_obs`, `final_info`, under `"SameStep"`), and of environments that were lost.
    ///
    /// Raises a `ValueError` for actions of another shape or that are not finite, a `TypeError` for what are no real numbers, and a
    /// `RuntimeError` (Gymnasium's `ResetNeeded` and `ClosedEnvironmentError` in its environments) before the first `reset`, after the end
    /// of an episode under `"Disabled"`, and after `close`.
    fn step<'py>(slf: &Bound<'py, Self>, actions: &Bound<'py, PyAny>) -> PyResult<Step<'py>> {
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, books, .. } = open(slf, &mut guard)?;
        books.expect_action(slf)?;
        with_table!(held, table => step::take(slf.py(), &mut **table, books, actions))
    }

    /// Takes what a step takes and does nothing with it, for benchmarks.
    fn _nothing(&self, actions: &Bound<'_, PyAny>) {
        let _ = (self, actions);
    }

    /// Begins episodes: a first one where there is a seed, otherwise the next, where `mask` has a `True`. Gives what is seen then.
    #[pyo3(signature = (seeds, mask=None))]
    fn _reset<'py>(
        slf: &Bound<'py, Self>,
        seeds: Vec<Option<u64>>,
        mask: Option<Bound<'py, PyArray1<bool>>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, books, .. } = open(slf, &mut guard)?;
        let mask = match mask {
            Some(mask) => mask.to_vec()?,
            None => vec![true; books.len],
        };
        if seeds.len() != books.len || mask.len() != books.len {
            let (seeds, masks, len) = (seeds.len(), mask.len(), books.len);
            return Err(refused(format!(
                "{seeds} seeds and {masks} marks are for {len} environments"
            )));
        }
        let chosen = |n: usize| seeds[n].filter(|_| mask[n]);
        let first: Vec<Option<u64>> = (0..books.len).map(chosen).collect();
        let next: Vec<bool> = (0..books.len).map(|n| mask[n] && seeds[n].is_none()).collect();
        with_table!(held, table => {
            let begun = table.seed(&first).and_then(|()| table.reset(&next));
            begun.map_err(Raised::raised)?;
            books.begun(&mask);
            step::look(slf.py(), &mut **table, books)
        })
    }

    /// Ends episodes where there is a `True`.
    fn _end(slf: &Bound<'_, Self>, which: Bound<'_, PyArray1<bool>>) -> PyResult<()> {
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, .. } = open(slf, &mut guard)?;
        let which = which.to_vec()?;
        with_table!(held, table => table.end(&which)).map_err(Raised::raised)
    }

    /// Room for a rollout of so many steps.
    fn _memory(
        slf: &Bound<'_, Self>,
        horizon: usize,
        log_probabilities: bool,
        values: bool,
    ) -> PyResult<Memory> {
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, books, .. } = open(slf, &mut guard)?;
        let plan = Plan::new(horizon, books.len).truncated();
        let plan = Plan { log_probability: log_probabilities, value: values, ..plan };
        Memory::new(held, plan)
    }

    /// Fills a rollout with what all do under a policy. Gives what is seen then.
    fn _rollout<'py>(
        slf: &Bound<'py, Self>,
        policy: Told<'py>,
        memory: &Memory,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, books, .. } = open(slf, &mut guard)?;
        books.expect_action(slf)?;
        let (ended, outcome) = memory.fill(slf.py(), held, &policy, books.substeps)?;
        if !ended.is_empty() {
            books.stood(&ended);
        }
        outcome?;
        with_table!(held, table => step::look_apart(slf.py(), &mut **table, books))
    }

    /// Positions and velocities, `(num_envs, 2)`.
    fn _states<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        fn states<'py, T: Number>(
            py: Python<'py>,
            table: &dyn Table<T>,
            len: usize,
        ) -> PyResult<Bound<'py, PyAny>> {
            let all: Bound<'py, Array<T, 2>> = fresh(py, [len, 2])?;
            for (n, row) in room(&all).chunks_exact_mut(2).enumerate() {
                row.copy_from_slice(&table.state(n).unwrap_or([T::zero(); 2]));
            }
            Ok(all.into_any())
        }
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, books, .. } = open(slf, &mut guard)?;
        with_table!(held, table => states(slf.py(), &**table, books.len))
    }

    /// All that they are, to be restored by environments with the same settings.
    fn _state<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyBytes>, bool, Vec<u8>)> {
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, books, .. } = open(slf, &mut guard)?;
        let state = with_table!(held, table => table.to_bytes());
        Ok((PyBytes::new(slf.py(), &state), books.untouched, books.standing.clone()))
    }

    /// Makes them what they were.
    fn _restore(slf: &Bound<'_, Self>, state: (Vec<u8>, bool, Vec<u8>)) -> PyResult<()> {
        let mut guard = slf.get().inner.enter(slf.py())?;
        let Inner { held, books, .. } = open(slf, &mut guard)?;
        let (bytes, untouched, standing) = state;
        if standing.len() != books.len {
            return Err(refused(format!("a state of {} environments", standing.len())));
        }
        with_table!(held, table => table.restore(&bytes)).map_err(Raised::raised)?;
        (books.untouched, books.standing) = (untouched, standing);
        Ok(())
    }

    /// Gives all memory back. Arrays that were handed out stay.
    fn _close(&self, py: Python<'_>) -> PyResult<()> {
        *self.inner.enter(py)? = None;
        Ok(())
    }
}

/// What is inside, if it was not closed, with threads of this process.
fn open<'a>(
    slf: &Bound<'_, Batch>,
    guard: &'a mut Entered<'_, Option<Inner>>,
) -> PyResult<&'a mut Inner> {
    let Some(inner) = guard.as_mut() else {
        return Err(raise(slf, "_closed_error", "the environments are closed"));
    };
    // A process that was forked has none of the threads.
    if inner.threads > 1 && inner.process != std::process::id() {
        let execution = Execution::serial().threads(inner.threads);
        let execution = execution.map_err(|error| EnvironmentError::from(error).raised())?;
        with_table!(&mut inner.held, table => table.execute(execution));
        inner.process = std::process::id();
    }
    Ok(inner)
}

/// The exception that a class of Python's has for this, or a `RuntimeError`.
pub(crate) fn raise(slf: &Bound<'_, Batch>, kind: &str, text: &str) -> PyErr {
    match slf.getattr(kind).and_then(|kind| kind.call1((text,))) {
        Ok(error) => PyErr::from_value(error),
        Err(_) => PyRuntimeError::new_err(text.to_owned()),
    }
}
