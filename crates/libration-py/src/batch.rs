//! The Python class `Batch`: environments that Python steps.

use libration::ensemble::Execution;
use libration::rl::{EnvironmentError, Plan};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::any_batch::{AnyBatch, with_batch};
use crate::checked_mutex::{CheckedGuard, CheckedMutex};
use crate::episode_states::{episode_numbers, put_states, states};
use crate::error::{Raised, value_error};
use crate::policy::PolicyRequest;
use crate::rollout::Memory;
use crate::settings::Settings;
use crate::step::{self, EpisodeStates, SingleStep, Step};

/// Environments that the engine steps together, without Gymnasium.
///
/// Base class of the environments of `libration`.
#[pyclass(subclass, frozen, module = "libration._native")]
pub(crate) struct Batch {
    inner: CheckedMutex<Option<Inner>>,
}

/// State until the environments are closed.
struct Inner {
    batch: AnyBatch,
    episodes: EpisodeStates,
    /// The places of the numbers of a state among positions and velocities.
    places: Vec<usize>,
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
        Batch { inner: CheckedMutex::new(None) }
    }

    /// Creates the environments; `buffers` is the number of reused arrays, or 0 for new arrays in every step. With `rounds` observations of
    /// resets and steps are `float32`, whatever the float type of the engine.
    #[pyo3(signature = (settings, buffers, rounds=false))]
    fn _set_up(
        &self,
        py: Python<'_>,
        settings: Settings,
        buffers: usize,
        rounds: bool,
    ) -> PyResult<()> {
        *self.inner.lock(py)? = Some(Inner {
            batch: settings.batch()?,
            episodes: EpisodeStates::new(&settings, buffers, rounds)?,
            places: settings.places()?,
            process: std::process::id(),
            threads: settings.execution()?.thread_count(),
        });
        Ok(())
    }

    /// Takes one step with an action per environment: an array of shape `(num_envs, 1)` or `(num_envs,)`, in the unit of an acceleration;
    /// of a system by equations `(num_envs, n)` with a number for each input.
    ///
    /// Returns observations `(num_envs, n)`, rewards, terminations and truncations `(num_envs,)`, and a dictionary with the ended episodes
    /// (`final_obs`, `final_info`, with `"SameStep"`) and the environments whose state is not finite (`lost`).
    ///
    /// Raises a `ValueError` for actions with a wrong shape or that are not finite, a `TypeError` for actions that are not real numbers, and a
    /// `RuntimeError` (Gymnasium's `ResetNeeded` and `ClosedEnvironmentError` in its environments) before the first `reset`, after the end
    /// of an episode under `"Disabled"`, and after `close`.
    fn step<'py>(
        slf: &Bound<'py, Self>,
        actions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        let mut guard = slf.get().inner.lock(py)?;
        let tells = open(slf, &mut guard)?.episodes.tells;
        // A function of Python reads them, and takes the lock itself.
        drop(guard);
        let before = tells.then(|| slf.call_method0("_final_parameters")).transpose()?;
        let mut guard = slf.get().inner.lock(py)?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        episodes.expect_action(slf)?;
        let results: Step<'py> = with_batch!(batch, environments => step::take(py, &mut **environments, episodes, actions))?;
        drop(guard);
        let results = results.into_pyobject(py)?;
        match before {
            Some(before) => Ok(slf.call_method1("_told", (results, before))?.cast_into()?),
            None => Ok(results),
        }
    }

    /// Takes one step of the only environment: the observation `(n,)`, the reward, whether the episode was terminated and truncated, and a
    /// dictionary with `lost` if its state is not finite.
    ///
    /// Raises as `step`.
    fn _step_single<'py>(
        slf: &Bound<'py, Self>,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<SingleStep<'py>> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        episodes.expect_action(slf)?;
        if episodes.len != 1 {
            return Err(value_error(format!(
                "one of {} environments cannot be stepped",
                episodes.len
            )));
        }
        with_batch!(batch, environments => step::take_single(slf.py(), &mut **environments, episodes, action))
    }

    /// Accepts the arguments of a step and does nothing, for benchmarks.
    fn _nothing(&self, actions: &Bound<'_, PyAny>) {
        let _ = (self, actions);
    }

    /// Begins episodes of the environments in `mask`: the first one under a seed, else the next one. Returns the observations.
    #[pyo3(signature = (seeds, mask=None))]
    fn _reset<'py>(
        slf: &Bound<'py, Self>,
        seeds: Vec<Option<u64>>,
        mask: Option<Bound<'py, PyArray1<bool>>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        let mask = match mask {
            Some(mask) => mask.to_vec()?,
            None => vec![true; episodes.len],
        };
        if seeds.len() != episodes.len || mask.len() != episodes.len {
            let (seeds, masks, len) = (seeds.len(), mask.len(), episodes.len);
            return Err(value_error(format!(
                "{seeds} seeds and {masks} marks are for {len} environments"
            )));
        }
        let chosen = |n: usize| seeds[n].filter(|_| mask[n]);
        let first: Vec<Option<u64>> = (0..episodes.len).map(chosen).collect();
        let next: Vec<bool> = (0..episodes.len).map(|n| mask[n] && seeds[n].is_none()).collect();
        with_batch!(batch, environments => {
            let begun = environments.seed(&first).and_then(|()| environments.reset(&next));
            begun.map_err(Raised::raised)?;
            episodes.begun(&mask);
            step::observe(slf.py(), &mut **environments, episodes, true)
        })
    }

    /// Ends the episodes of the selected environments.
    fn _end(slf: &Bound<'_, Self>, which: Bound<'_, PyArray1<bool>>) -> PyResult<()> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, .. } = open(slf, &mut guard)?;
        let which = which.to_vec()?;
        with_batch!(batch, environments => environments.end(&which)).map_err(Raised::raised)
    }

    /// Returns memory for a rollout of `horizon` steps.
    fn _memory(
        slf: &Bound<'_, Self>,
        horizon: usize,
        log_probabilities: bool,
        values: bool,
    ) -> PyResult<Memory> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        let plan = Plan::new(horizon, episodes.len).truncated();
        let plan = Plan { log_probability: log_probabilities, value: values, ..plan };
        Memory::new(batch, plan)
    }

    /// Fills a rollout under a policy. Returns the observations after it.
    fn _rollout<'py>(
        slf: &Bound<'py, Self>,
        policy: PolicyRequest<'py>,
        memory: &Memory,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        episodes.expect_action(slf)?;
        let (ended, outcome) = memory.fill(slf.py(), batch, &policy, episodes.substeps)?;
        if !ended.is_empty() {
            episodes.stood(&ended);
        }
        outcome?;
        with_batch!(batch, environments => step::observe(slf.py(), &mut **environments, episodes, false))
    }

    /// Returns positions and velocities, `(num_envs, 2)`; of a system by equations its states.
    fn _states<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, places, .. } = open(slf, &mut guard)?;
        with_batch!(batch, environments => states(slf.py(), &**environments, episodes.len, places))
    }

    /// Puts environments `which` at the rows of `states`. Returns the observations.
    fn _set_states<'py>(
        slf: &Bound<'py, Self>,
        states: Vec<Vec<f64>>,
        which: Vec<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, places, .. } = open(slf, &mut guard)?;
        with_batch!(batch, environments => {
            let rows = which.into_iter().zip(states);
            put_states(&mut **environments, places, rows).map_err(Raised::raised)?;
            step::observe(slf.py(), &mut **environments, episodes, true)
        })
    }

    /// Puts environments `which` at starts in ranges of the numbers of a state. Returns the observations.
    fn _start_within<'py>(
        slf: &Bound<'py, Self>,
        ranges: Vec<[f64; 2]>,
        which: Vec<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, places, .. } = open(slf, &mut guard)?;
        with_batch!(batch, environments => {
            for n in which {
                let Some((mut state, episode)) = environments.state(n).zip(environments.episode(n))
                else {
                    continue;
                };
                let mut all = vec![[0.0; 2]; state.len()];
                places.iter().zip(&ranges).for_each(|(&place, &range)| all[place] = range);
                let drawn = episode.start_within(&all);
                places.iter().for_each(|&place| state[place] = drawn[place]);
                environments.set_state(n, &state).map_err(Raised::raised)?;
            }
            step::observe(slf.py(), &mut **environments, episodes, true)
        })
    }

    /// Returns what is drawn of each episode, `(num_envs, n)`: parameters that vary, largest commands unless all are constants, latencies of
    /// observations and actions in steps of the integrator, error scales of clock and sensor, times of the answers `ahead` steps later if they are drawn, and rates of
    /// clocks.
    #[pyo3(signature = (ahead=0))]
    fn _episode_numbers<'py>(slf: &Bound<'py, Self>, ahead: u64) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        with_batch!(batch, environments => episode_numbers(slf.py(), &**environments, episodes.skew, ahead))
    }

    /// Returns the state, for environments with the same settings.
    fn _state<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyBytes>, bool, Vec<u8>)> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        let state = with_batch!(batch, environments => environments.to_bytes());
        Ok((PyBytes::new(slf.py(), &state), episodes.untouched, episodes.standing.clone()))
    }

    /// Restores a state.
    fn _restore(slf: &Bound<'_, Self>, state: (Vec<u8>, bool, Vec<u8>)) -> PyResult<()> {
        let mut guard = slf.get().inner.lock(slf.py())?;
        let Inner { batch, episodes, .. } = open(slf, &mut guard)?;
        let (bytes, untouched, standing) = state;
        if standing.len() != episodes.len {
            return Err(value_error(format!("a state of {} environments", standing.len())));
        }
        with_batch!(batch, environments => environments.restore(&bytes)).map_err(Raised::raised)?;
        (episodes.untouched, episodes.standing) = (untouched, standing);
        Ok(())
    }

    /// Releases all memory. Arrays that Python references stay valid.
    fn _close(&self, py: Python<'_>) -> PyResult<()> {
        *self.inner.lock(py)? = None;
        Ok(())
    }
}

/// Returns the state, with threads of this process, or an error if the environments are closed.
fn open<'a>(
    slf: &Bound<'_, Batch>,
    guard: &'a mut CheckedGuard<'_, Option<Inner>>,
) -> PyResult<&'a mut Inner> {
    let Some(inner) = guard.as_mut() else {
        return Err(raise(slf, "_closed_error", "the environments are closed"));
    };
    // A process that was forked has none of the threads.
    if inner.threads > 1 && inner.process != std::process::id() {
        let execution = Execution::serial().threads(inner.threads);
        let execution = execution.map_err(|error| EnvironmentError::from(error).raised())?;
        with_batch!(&mut inner.batch, environments => environments.execute(execution));
        inner.process = std::process::id();
    }
    Ok(inner)
}

/// Returns the exception of the Python class for this case, or a `RuntimeError`.
pub(crate) fn raise(slf: &Bound<'_, Batch>, kind: &str, text: &str) -> PyErr {
    match slf.getattr(kind).and_then(|kind| kind.call1((text,))) {
        Ok(error) => PyErr::from_value(error),
        Err(_) => PyRuntimeError::new_err(text.to_owned()),
    }
}
