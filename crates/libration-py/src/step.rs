//! A step of environments with NumPy arrays.

use std::iter::repeat_with;
use std::sync::Arc;

use libration::control::Jitter;
use libration::rl::{Autoreset, EpisodeEnds, ProgramPolicy, StepBuffers};
use libration_env::environments::AnyEnvironments;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use crate::actions::with_actions;
use crate::array::{
    Array, Number, ReusedArray, allocate_by_size, bytes_of, helper, lies_in, reuse_or_allocate,
    view_mut,
};
use crate::batch::{Batch, raise};
use crate::error::Raised;
use crate::observations::{Observations, Rounding, array_of};
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
    levels: Arc<[f64]>,
    rounding: Rounding,
    /// Whether the infos of steps have the numbers of episodes.
    pub(crate) tells: bool,
    /// The law of the rates of clocks.
    pub(crate) skew: Jitter,
}

/// Arrays that a step fills: what is seen, paid, over and cut off.
struct Row<'py, T> {
    seen: Observations<'py, T>,
    reward: Bound<'py, Array<T, 1>>,
    terminated: Bound<'py, Array<bool, 1>>,
    truncated: Bound<'py, Array<bool, 1>>,
}

/// The results of a step.
pub(crate) type Step<'py> = (Any<'py>, Any<'py>, Any<'py>, Any<'py>, Bound<'py, PyDict>);
type Any<'py> = Bound<'py, PyAny>;

/// The same of the only environment: numbers and flags in place of arrays.
pub(crate) type SingleStep<'py> = (Any<'py>, f64, bool, bool, Bound<'py, PyDict>);

/// Who asks for arrays of their own has those of the last step in hand while the next is written.
const IN_HAND: usize = 2;

/// More steps than this are worth giving up the interpreter's lock, which takes as long as some hundred of them.
const WORTH_A_LOCK: usize = 512;

impl EpisodeStates {
    pub(crate) fn new(settings: &Settings, buffers: usize, rounds: bool) -> PyResult<Self> {
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
            levels: settings.levels.as_slice().into(),
            rounding: Rounding::new(rounds),
            tells: settings.parameter_infos,
            skew: settings.skew()?,
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

    /// The arrays of the next step.
    fn row<'py, T: Number>(
        &mut self,
        py: Python<'py>,
        observations: usize,
    ) -> PyResult<Row<'py, T>> {
        let (len, shared) = (self.len, self.shared);
        let [seen, reward, terminated, truncated] = &mut self.rows[self.turn];
        let row = Row {
            seen: Observations::reused(py, seen, [len, observations], shared, &self.rounding)?,
            reward: reuse_or_allocate(py, reward, [len], shared)?,
            terminated: reuse_or_allocate(py, terminated, [len], shared)?,
            truncated: reuse_or_allocate(py, truncated, [len], shared)?,
        };
        self.turn = (self.turn + 1) % self.rows.len();
        Ok(row)
    }
}

/// The current observations, in an array of their own; `rounds` as those of a step are, or else in the float type of the engine.
pub(crate) fn observe<'py, T: Number>(
    py: Python<'py>,
    environments: &mut dyn AnyEnvironments<T>,
    episodes: &mut EpisodeStates,
    rounds: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let shape = [episodes.len, environments.sizes()[0]];
    if rounds && episodes.rounding.applies::<T>() {
        let seen = Observations::<T>::reused(py, &mut None, shape, false, &episodes.rounding)?;
        let len = shape[0] * shape[1];
        environments.observe(episodes.rounding.room(len)).map_err(Raised::raised)?;
        return Ok(seen.filled(len, &mut episodes.rounding));
    }
    let seen = allocate_by_size(py, shape)?;
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
    let shape = [episodes.len, environments.sizes()[1]];
    let levels = Arc::clone(&episodes.levels);
    with_actions(given, &levels, shape, |actions| act(py, environments, episodes, actions))
}

fn act<'py, T: Number>(
    py: Python<'py>,
    environments: &mut dyn AnyEnvironments<T>,
    episodes: &mut EpisodeStates,
    actions: &[T],
) -> PyResult<Step<'py>> {
    let observations = environments.sizes()[0];
    let len = episodes.len * observations;
    let Row { seen, reward, terminated, truncated } = episodes.row::<T>(py, observations)?;
    // Who uses arrays again may ask for what an array of earlier steps says, and that is written now.
    let copied;
    let actions = if episodes.shared
        && (seen.has(actions)
            || lies_in(actions, &reward)
            || lies_in(actions, &terminated)
            || lies_in(actions, &truncated))
    {
        copied = actions.to_vec();
        &*copied
    } else {
        actions
    };
    let to = StepBuffers {
        seen: seen.target(len, &mut episodes.rounding),
        reward: view_mut(&reward),
        terminated: bytes_of(&terminated),
        truncated: bytes_of(&truncated),
    };
    let ends = advance(py, environments, [episodes.len, episodes.substeps], actions, to)?;
    if episodes.autoreset == Autoreset::Disabled && !ends.ends.is_empty() {
        let flags = bytes_of(&terminated).iter().zip(&*bytes_of(&truncated));
        let ended: Vec<u8> = flags.map(|(over, cut)| over | cut).collect();
        episodes.stood(&ended);
    }
    let infos = step_infos(py, &ends, episodes, observations)?;
    let seen = seen.filled(len, &mut episodes.rounding);
    Ok((seen, reward.into_any(), terminated.into_any(), truncated.into_any(), infos))
}

/// Takes a step of the only environment, whose results are no arrays but what is seen, `(n,)`.
pub(crate) fn take_single<'py, T: Number>(
    py: Python<'py>,
    environments: &mut dyn AnyEnvironments<T>,
    episodes: &mut EpisodeStates,
    given: &Bound<'py, PyAny>,
) -> PyResult<SingleStep<'py>> {
    let [observations, width] = environments.sizes();
    let levels = Arc::clone(&episodes.levels);
    with_actions(given, &levels, [1, width], |actions| {
        let (mut reward, mut terminated, mut truncated) = ([T::zero()], [0], [0]);
        let seen = episodes.rounding.room::<T>(observations);
        let to = StepBuffers {
            seen,
            reward: &mut reward,
            terminated: &mut terminated,
            truncated: &mut truncated,
        };
        let ends = advance(py, environments, [1, episodes.substeps], actions, to)?;
        episodes.stood(&[terminated[0] | truncated[0]]);
        let infos = PyDict::new(py);
        if ends.ends.iter().any(|end| end.lost) {
            infos.set_item("lost", true)?;
        }
        let seen = episodes.rounding.array::<T>(py, observations)?;
        Ok((seen, reward[0].to_f64(), terminated[0] != 0, truncated[0] != 0, infos))
    })
}

/// Takes a step of so many environments and steps of the integrator, without the interpreter's lock where that is worth it.
fn advance<T: Number>(
    py: Python<'_>,
    environments: &mut dyn AnyEnvironments<T>,
    [len, substeps]: [usize; 2],
    actions: &[T],
    to: StepBuffers<'_, T>,
) -> PyResult<EpisodeEnds<T>> {
    let act = || environments.act(ProgramPolicy::ActionSequence(actions), to);
    let ends = match len.saturating_mul(substeps) > WORTH_A_LOCK {
        true => py.detach(act),
        false => act(),
    };
    ends.map_err(Raised::raised)
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
    let shape = [ends.ends.len(), observations];
    let seen = array_of(py, &ends.observations, shape, &episodes.rounding)?;
    let who: Vec<usize> = ends.ends.iter().map(|end| end.environment).collect();
    let lost: Vec<bool> = ends.ends.iter().map(|end| end.lost).collect();
    let arguments = (episodes.len, same_step, who, seen, lost);
    Ok(helper(py, &INFOS, "infos")?.call1(arguments)?.cast_into()?)
}

static INFOS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
