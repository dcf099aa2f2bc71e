//! A step of environments with NumPy arrays.

use std::iter::repeat_with;

use libration::rl::{Autoreset, EpisodeEnds, ProgramPolicy, StepBuffers};
use libration_env::environments::AnyEnvironments;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use crate::array::{
    Array, Number, ReusedArray, allocate, allocate_by_size, are_finite, bytes_of,
    contiguous_actions, lies_in, reuse_or_allocate, view_mut,
};
use crate::batch::{Batch, raise};
use crate::error::{Raised, value_error};
use crate::settings::Settings;

/// Episode state and arrays of environments.
pub(crate) struct EpisodeStates {
    pub(crate) len: usize,
    autoreset: Autoreset,
    /// Whether nothing has begun yet.
    pub(crate) untouched: bool,
    /// Of environments that wait for their reset, not 0.
    pub(crate) standing: Vec<u8>,
    /// Rows of arrays, whose turn it is, and whether they are written again whoever has them.
    rows: Vec<[Option<ReusedArray>; 4]>,
    turn: usize,
    shared: bool,
    /// Steps of the integrator for an action.
    pub(crate) substeps: usize,
    /// Commands of discrete actions; empty for commands of any value.
    levels: Vec<f64>,
    /// Whether the infos of steps have the numbers of episodes.
    pub(crate) tells: bool,
}

/// Arrays that a step fills: what is seen, paid, over and cut off.
struct Row<'py, T> {
    seen: Bound<'py, Array<T, 2>>,
    reward: Bound<'py, Array<T, 1>>,
    terminated: Bound<'py, Array<bool, 1>>,
    truncated: Bound<'py, Array<bool, 1>>,
}

/// The results of a step.
pub(crate) type Step<'py> = (Any<'py>, Any<'py>, Any<'py>, Any<'py>, Bound<'py, PyDict>);
type Any<'py> = Bound<'py, PyAny>;

/// Who asks for arrays of their own has those of the last step in hand while the next is written.
const IN_HAND: usize = 2;

/// More steps than this are worth giving up the interpreter's lock, which takes as long as some hundred of them.
const WORTH_A_LOCK: usize = 512;

impl EpisodeStates {
    pub(crate) fn new(settings: &Settings, buffers: usize) -> PyResult<Self> {
        let rows = if buffers > 0 { buffers } else { IN_HAND };
        let len = settings.num_envs;
        Ok(EpisodeStates {
            len,
            autoreset: settings.autoreset()?,
            untouched: true,
            standing: vec![0; len],
            rows: repeat_with(Default::default).take(rows).collect(),
            turn: 0,
            shared: buffers > 0,
            substeps: settings.substeps as usize,
            levels: settings.levels.clone(),
            tells: settings.parameter_infos,
        })
    }

    /// Nothing, if all can take an action.
    pub(crate) fn expect_action(&self, slf: &Bound<'_, Batch>) -> PyResult<()> {
        if self.untouched {
            let text = "environments must be reset before their first step";
            return Err(raise(slf, "_reset_needed", text));
        }
        if self.autoreset != Autoreset::Disabled {
            return Ok(());
        }
        match self.standing.iter().position(|&stands| stands != 0) {
            None => Ok(()),
            Some(n) => {
                let text = format!(
                    "the episode of environment {n} is over: reset it before the next step"
                );
                Err(raise(slf, "_reset_needed", &text))
            }
        }
    }

    /// Episodes have begun where there is a `true`.
    pub(crate) fn begun(&mut self, which: &[bool]) {
        self.untouched = false;
        let marked = self.standing.iter_mut().zip(which).filter(|(_, which)| **which);
        marked.for_each(|(stands, _)| *stands = 0);
    }

    /// Episodes ended where this is not 0, and nothing follows if it is to be asked for.
    pub(crate) fn stood(&mut self, ended: &[u8]) {
        if self.autoreset == Autoreset::Disabled {
            self.standing.copy_from_slice(ended);
        }
    }

    /// The command of an integer that is the discrete action of the only environment.
    fn single_choice<T: Number>(&self, given: &Bound<'_, PyAny>) -> Option<[T; 1]> {
        if self.levels.is_empty() || self.len != 1 {
            return None;
        }
        let level = given.extract().ok().and_then(|i: usize| self.levels.get(i));
        level.map(|&level| [T::from_f64(level)])
    }

    /// The arrays of the next step.
    fn row<'py, T: Number>(
        &mut self,
        py: Python<'py>,
        observations: usize,
    ) -> PyResult<Row<'py, T>> {
        let (len, shared) = (self.len, self.shared);
        let [seen, reward, terminated, truncated] = &mut self.rows[self.turn];
        let row = Row {
            seen: reuse_or_allocate(py, seen, [len, observations], shared)?,
            reward: reuse_or_allocate(py, reward, [len], shared)?,
            terminated: reuse_or_allocate(py, terminated, [len], shared)?,
            truncated: reuse_or_allocate(py, truncated, [len], shared)?,
        };
        self.turn = (self.turn + 1) % self.rows.len();
        Ok(row)
    }
}

/// The current observations, in an array of their own.
pub(crate) fn observe<'py, T: Number>(
    py: Python<'py>,
    environments: &mut dyn AnyEnvironments<T>,
    episodes: &EpisodeStates,
) -> PyResult<Bound<'py, PyAny>> {
    let seen = allocate_by_size(py, [episodes.len, environments.sizes()[0]])?;
    let to = view_mut(&seen);
    py.detach(|| environments.observe(to)).map_err(Raised::raised)?;
    Ok(seen.into_any())
}

/// Takes a step, and says what ended with it.
pub(crate) fn take<'py, T: Number>(
    py: Python<'py>,
    environments: &mut dyn AnyEnvironments<T>,
    episodes: &mut EpisodeStates,
    given: &Bound<'py, PyAny>,
) -> PyResult<Step<'py>> {
    let made;
    let shape = [episodes.len, environments.sizes()[1]];
    let is_discrete = !episodes.levels.is_empty();
    let chosen = episodes.single_choice::<T>(given);
    let direct = || contiguous_actions(given, shape).filter(|_| !is_discrete);
    let actions: &[T] = match chosen.as_ref().map(<[T; 1]>::as_slice).or_else(direct) {
        Some(actions) => actions,
        None => {
            made = if is_discrete {
                let levels = episodes.levels.clone();
                helper(py, &CHOICES, "choices")?.call1((given, shape[0], levels, T::NUMPY))?
            } else {
                helper(py, &ACTIONS, "actions")?.call1((given, shape, T::NUMPY))?
            };
            let error = || PyTypeError::new_err("actions are no array");
            contiguous_actions(&made, shape).ok_or_else(error)?
        }
    };
    if !are_finite(actions) {
        let n = actions.iter().position(|action| !action.is_finite()).unwrap_or(0);
        let index = match shape[1] {
            1 => n.to_string(),
            width => format!("{}, {}", n / width, n % width),
        };
        let text = format!("actions[{index}] is {:?}, but it must be finite", actions[n]);
        return Err(value_error(text));
    }
    let row = episodes.row::<T>(py, environments.sizes()[0])?;
    let Row { seen, reward, terminated, truncated } = &row;
    // Who uses arrays again may ask for what an array of earlier steps says, and that is written now.
    let copied;
    let actions = if episodes.shared
        && (lies_in(actions, seen)
            || lies_in(actions, reward)
            || lies_in(actions, terminated)
            || lies_in(actions, truncated))
    {
        copied = actions.to_vec();
        &*copied
    } else {
        actions
    };
    let (seen, reward) = (view_mut(seen), view_mut(reward));
    let (terminated, truncated) = (bytes_of(terminated), bytes_of(truncated));
    let to = StepBuffers { seen, reward, terminated: &mut *terminated, truncated: &mut *truncated };
    let act = || environments.act(ProgramPolicy::ActionSequence(actions), to);
    let ends = if episodes.len.saturating_mul(episodes.substeps) > WORTH_A_LOCK {
        py.detach(act)
    } else {
        act()
    };
    let ends = ends.map_err(Raised::raised)?;
    if episodes.autoreset == Autoreset::Disabled && !ends.ends.is_empty() {
        let ended: Vec<u8> =
            terminated.iter().zip(&*truncated).map(|(over, cut)| over | cut).collect();
        episodes.stood(&ended);
    }
    let infos = step_infos(py, &ends, episodes, environments.sizes()[0])?;
    let Row { seen, reward, terminated, truncated } = row;
    Ok((seen.into_any(), reward.into_any(), terminated.into_any(), truncated.into_any(), infos))
}

/// The contents of the dictionary of a step.
fn step_infos<'py, T: Number>(
    py: Python<'py>,
    ends: &EpisodeEnds<T>,
    episodes: &EpisodeStates,
    observations: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let same_step = episodes.autoreset == Autoreset::SameStep;
    if ends.ends.is_empty() || !(same_step || ends.ends.iter().any(|end| end.lost)) {
        return Ok(PyDict::new(py));
    }
    let seen: Bound<'py, Array<T, 2>> = allocate(py, [ends.ends.len(), observations])?;
    view_mut(&seen).copy_from_slice(&ends.observations);
    let who: Vec<usize> = ends.ends.iter().map(|end| end.environment).collect();
    let lost: Vec<bool> = ends.ends.iter().map(|end| end.lost).collect();
    let arguments = (episodes.len, same_step, who, seen, lost);
    Ok(helper(py, &INFOS, "infos")?.call1(arguments)?.cast_into()?)
}

static ACTIONS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
static CHOICES: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
static INFOS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// A function of Python's for what is rare.
fn helper<'py>(
    py: Python<'py>,
    cell: &'static PyOnceLock<Py<PyAny>>,
    name: &str,
) -> PyResult<&'py Bound<'py, PyAny>> {
    let import = || Ok::<_, PyErr>(py.import("libration._arrays")?.getattr(name)?.unbind());
    Ok(cell.get_or_try_init(py, import)?.bind(py))
}
