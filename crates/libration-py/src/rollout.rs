//! Rollouts in Python: memory of the engine as NumPy arrays.

use libration::rl::{Discounts, EpisodeEnd, EpisodeEnds, Estimates, Plan};
use libration_env::environments::{AnyEnvironments, AnyRollout};
use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::any_batch::AnyBatch;
use crate::array::{Array, Number, allocate, view, view_mut, view_of_flags};
use crate::checked_mutex::{CheckedGuard, CheckedMutex};
use crate::error::{Raised, value_error};
use crate::policy::{Policy, PolicyRequest};
use crate::time_slices::run_in_slices;

/// Memory of a rollout, allocated once and reused.
#[pyclass(frozen, module = "libration._native")]
pub(crate) struct Memory {
    tensors: CheckedMutex<AnyTensors>,
}

/// Tensors of either float type.
pub(crate) enum AnyTensors {
    F32(Box<dyn AnyRollout<f32>>),
    F64(Box<dyn AnyRollout<f64>>),
}

/// Evaluates an expression for the tensors of either float type.
macro_rules! with_tensors {
    ($any:expr, $tensors:ident => $work:expr) => {
        match $any {
            AnyTensors::F32($tensors) => $work,
            AnyTensors::F64($tensors) => $work,
        }
    };
}

/// Steps of the integrator, of all environments, before it is known how long they take under a policy.
const FIRST: usize = 1 << 16;

impl Memory {
    /// Allocates a rollout of a batch.
    pub(crate) fn new(batch: &AnyBatch, plan: Plan) -> PyResult<Self> {
        let tensors = match batch {
            AnyBatch::F32(environments) => {
                AnyTensors::F32(environments.new_rollout(plan).map_err(Raised::raised)?)
            }
            AnyBatch::F64(environments) => {
                AnyTensors::F64(environments.new_rollout(plan).map_err(Raised::raised)?)
            }
        };
        Ok(Memory { tensors: CheckedMutex::new(tensors) })
    }

    /// Returns the tensors.
    pub(crate) fn tensors(&self, py: Python<'_>) -> PyResult<CheckedGuard<'_, AnyTensors>> {
        self.tensors.lock(py)
    }

    /// Fills all of it. Gives which environments ended with the last step that was taken, and why it was the last.
    pub(crate) fn fill(
        &self,
        py: Python<'_>,
        batch: &mut AnyBatch,
        policy: &PolicyRequest<'_>,
        substeps: usize,
    ) -> PyResult<(Vec<u8>, PyResult<()>)> {
        match (batch, &mut *self.tensors(py)?) {
            (AnyBatch::F32(environments), AnyTensors::F32(tensors)) => {
                Ok(filled(py, &mut **environments, &Policy::new(policy)?, &mut **tensors, substeps))
            }
            (AnyBatch::F64(environments), AnyTensors::F64(tensors)) => {
                Ok(filled(py, &mut **environments, &Policy::new(policy)?, &mut **tensors, substeps))
            }
            _ => {
                Err(value_error("the rollout is of another dtype than the environments".to_owned()))
            }
        }
    }
}

/// Fills tensors piece by piece. Gives which environments ended with the last step that was taken, and why it was the last.
fn filled<T: Number>(
    py: Python<'_>,
    environments: &mut dyn AnyEnvironments<T>,
    policy: &Policy<T>,
    tensors: &mut dyn AnyRollout<T>,
    substeps: usize,
) -> (Vec<u8>, PyResult<()>) {
    let Plan { horizon, environments: count, .. } = tensors.plan();
    let first = FIRST / count.saturating_mul(substeps).max(1);
    let mut taken = 0;
    let outcome = run_in_slices(py, horizon as u64, first as u64, |piece| {
        let rows = piece.start as usize..piece.end as usize;
        let policy = policy.sized(tensors.sizes()[1]);
        py.detach(|| environments.fill(policy, tensors, rows)).map_err(Raised::raised)?;
        taken = piece.end as usize;
        Ok(())
    });
    let last = taken.saturating_sub(1) * count..taken * count;
    let flags = tensors.terminated()[last.clone()].iter().zip(&tensors.truncated()[last]);
    (flags.map(|(over, cut)| over | cut).collect(), outcome)
}

#[pymethods]
impl Memory {
    /// Returns all tensors by name, without a copy.
    fn _arrays<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        fn arrays<'py, T: Number>(
            owner: &Bound<'py, Memory>,
            tensors: &dyn AnyRollout<T>,
        ) -> PyResult<Bound<'py, PyDict>> {
            let Plan { horizon, environments, .. } = tensors.plan();
            let all = PyDict::new(owner.py());
            let [observations, actions] = tensors.sizes();
            for (name, numbers, each) in [
                ("observations", tensors.observation(), observations),
                ("actions", tensors.action(), actions),
                ("rewards", tensors.reward(), 0),
                ("log_probabilities", tensors.log_probability(), 0),
                ("values", tensors.value(), 0),
            ] {
                if numbers.is_empty() {
                    continue;
                }
                let array = match each {
                    0 => view(owner.as_any(), numbers, [horizon, environments]),
                    _ => view(owner.as_any(), numbers, [horizon, environments, each]),
                };
                all.set_item(name, array?)?;
            }
            for (name, flags) in
                [("terminated", tensors.terminated()), ("truncated", tensors.truncated())]
            {
                let flags = view_of_flags(owner.as_any(), flags, [horizon, environments])?;
                all.set_item(name, flags)?;
            }
            Ok(all)
        }
        with_tensors!(&*slf.get().tensors(slf.py())?, tensors => arrays(slf, &**tensors))
    }

    /// Returns the columns of ended episodes, by step and environment.
    fn _ends<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        fn ends<'py, T: Number>(
            py: Python<'py>,
            tensors: &dyn AnyRollout<T>,
        ) -> PyResult<Bound<'py, PyDict>> {
            fn column<'py, X: Element, T>(
                py: Python<'py>,
                ended: &EpisodeEnds<T>,
                of: impl Fn(&EpisodeEnd<T, 0>) -> X,
            ) -> Bound<'py, PyArray1<X>> {
                PyArray1::from_vec(py, ended.ends.iter().map(of).collect())
            }
            let ended = tensors.ends();
            let seen: Bound<'py, Array<T, 2>> =
                allocate(py, [ended.ends.len(), tensors.sizes()[0]])?;
            view_mut(&seen).copy_from_slice(&ended.observations);
            let all = PyDict::new(py);
            all.set_item("steps", column(py, &ended, |end| end.step))?;
            all.set_item("environments", column(py, &ended, |end| end.environment))?;
            all.set_item("lengths", column(py, &ended, |end| end.length))?;
            all.set_item("returns", column(py, &ended, |end| end.episode_return))?;
            all.set_item("lost", column(py, &ended, |end| end.lost))?;
            all.set_item("final_observations", seen)?;
            Ok(all)
        }
        with_tensors!(&*self.tensors(py)?, tensors => ends(py, &**tensors))
    }

    /// Returns whether each step is a transition, `(horizon, num_envs)`; false for a reset or an environment that waits for one.
    fn _transitions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (plan, all) =
            with_tensors!(&*self.tensors(py)?, tensors => (tensors.plan(), tensors.transitions()));
        let all = PyArray1::from_vec(py, all).reshape([plan.horizon, plan.environments])?;
        Ok(all.into_any())
    }

    /// Returns advantages and returns, `(horizon, num_envs)` each, from the tensor `values`.
    fn _estimates<'py>(
        &self,
        py: Python<'py>,
        gamma: f64,
        lambda_: f64,
        next: Vec<f64>,
        last: Vec<f64>,
    ) -> PyResult<[Bound<'py, PyAny>; 2]> {
        fn estimates<'py, T: Number>(
            py: Python<'py>,
            tensors: &dyn AnyRollout<T>,
            discounts: Discounts,
            [next, last]: [Vec<f64>; 2],
        ) -> PyResult<[Bound<'py, PyAny>; 2]> {
            let plan = tensors.plan();
            let rounded = |all: Vec<f64>| -> Vec<T> { all.into_iter().map(T::from_f64).collect() };
            let (next, last) = (rounded(next), rounded(last));
            let mut found = Estimates::new(plan).map_err(Raised::raised)?;
            py.detach(|| tensors.estimate(&mut found, discounts, &next, &last))
                .map_err(Raised::raised)?;
            let array = |numbers: &[T]| -> PyResult<_> {
                let array: Bound<'py, Array<T, 2>> =
                    allocate(py, [plan.horizon, plan.environments])?;
                view_mut(&array).copy_from_slice(numbers);
                Ok(array.into_any())
            };
            Ok([array(found.advantage())?, array(found.returns())?])
        }
        let discounts = Discounts { rewards: gamma, errors: lambda_ };
        with_tensors!(&*self.tensors(py)?, tensors => estimates(py, &**tensors, discounts, [next, last]))
    }
}
