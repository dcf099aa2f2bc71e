//! Replay buffers as Python holds them.

use bytemuck::cast_slice_mut;
use libration::ensemble::Execution;
use libration::replay::{Capacity, Columns, Draw, Lookahead, ReplayBuffer, ReplayError, Sequences};
use libration::rl::{EnvironmentError, ProgramRollout, Rollout};
use libration_env::environments::AnyRollout;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{Array, Number, allocate, bytes_of, view_mut};
use crate::checked_mutex::CheckedMutex;
use crate::error::{Raised, check_memory, value_error};
use crate::rollout::{AnyTensors, Memory};

/// The last transitions of many environments, of which batches are drawn.
#[pyclass(frozen, module = "libration._native")]
pub(crate) struct Buffer {
    store: CheckedMutex<AnyStore>,
}

/// A buffer of either float type.
enum AnyStore {
    F32(Box<dyn Store<f32>>),
    F64(Box<dyn Store<f64>>),
}

/// Does something with the buffer, whichever it is.
macro_rules! with_store {
    ($any:expr, $store:ident => $work:expr) => {
        match $any {
            AnyStore::F32($store) => $work,
            AnyStore::F64($store) => $work,
        }
    };
}

/// Which transitions are drawn, and how far each looks ahead.
#[derive(Clone, Copy, FromPyObject)]
#[pyo3(from_item_all)]
struct SampleRequest {
    len: usize,
    seed: u64,
    number: u64,
    steps: usize,
    gamma: f64,
    correction: Option<f64>,
}

/// A [`ReplayBuffer`] of environments that show any number of numbers.
trait Store<T>: Send {
    fn len(&self) -> u64;

    fn insert(&mut self, tensors: &mut dyn AnyRollout<T>, next: &[T]) -> Result<(), ReplayError>;

    fn sample<'py>(&self, py: Python<'py>, request: SampleRequest) -> PyResult<Bound<'py, PyDict>>;

    fn sequences<'py>(
        &self,
        py: Python<'py>,
        request: SampleRequest,
    ) -> PyResult<Bound<'py, PyDict>>;

    fn update(
        &mut self,
        numbers: &[u64],
        priorities: &[f64],
        exponent: f64,
    ) -> Result<usize, ReplayError>;
}

impl<T: Number, const O: usize> Store<T> for ReplayBuffer<T, O, 1> {
    fn len(&self) -> u64 {
        ReplayBuffer::len(self)
    }

    fn insert(&mut self, tensors: &mut dyn AnyRollout<T>, next: &[T]) -> Result<(), ReplayError> {
        let found = tensors.sizes()[0];
        let serial = Execution::serial();
        if let Some(rollout) = tensors.as_any().downcast_mut::<Rollout<T, O, 1>>() {
            return ReplayBuffer::insert(self, rollout, next, &serial);
        }
        // Environments with noise or with parameters that vary are programs.
        if let Some(rollout) = tensors.as_any().downcast_mut::<ProgramRollout<T>>() {
            return ReplayBuffer::insert(self, &rollout.to_sized::<O, 1>()?, next, &serial);
        }
        let name = "numbers that an environment of the rollout shows";
        Err(EnvironmentError::Shape { name, found, wanted: O }.into())
    }

    fn sample<'py>(&self, py: Python<'py>, request: SampleRequest) -> PyResult<Bound<'py, PyDict>> {
        let SampleRequest { len, seed, number, steps, gamma, correction } = request;
        check_memory(len as u128 * (8 + 2 + (2 * O + 4) as u128 * size_of::<T>() as u128))?;
        let numbers: Bound<'py, Array<u64, 1>> = allocate(py, [len])?;
        let rows = |each| allocate::<T, 2>(py, [len, each]);
        let (seen, actions, next) = (rows(O)?, rows(1)?, rows(O)?);
        let column = || allocate::<T, 1>(py, [len]);
        let (rewards, discounts, weights) = (column()?, column()?, column()?);
        let flags = || allocate::<bool, 1>(py, [len]);
        let (over, cut) = (flags()?, flags()?);
        let mut columns: Columns<'_, T, O, 1> = Columns {
            number: view_mut(&numbers),
            observation: cast_slice_mut(view_mut(&seen)),
            action: cast_slice_mut(view_mut(&actions)),
            reward: view_mut(&rewards),
            next_observation: cast_slice_mut(view_mut(&next)),
            terminated: bytes_of(&over),
            truncated: bytes_of(&cut),
            discount: view_mut(&discounts),
            weight: view_mut(&weights),
        };
        let (draw, ahead) = (Draw { seed, number }, Lookahead { steps, discount: gamma });
        let serial = Execution::serial();
        let drawn = py.detach(|| match correction {
            Some(beta) => self.sample_prioritised(draw, ahead, beta, &mut columns, &serial),
            None => ReplayBuffer::sample(self, draw, ahead, &mut columns, &serial),
        });
        drawn.map_err(Raised::raised)?;
        let all = PyDict::new(py);
        all.set_item("indices", numbers)?;
        all.set_item("observations", seen)?;
        all.set_item("actions", actions)?;
        all.set_item("rewards", rewards)?;
        all.set_item("next_observations", next)?;
        all.set_item("terminated", over)?;
        all.set_item("truncated", cut)?;
        all.set_item("discounts", discounts)?;
        all.set_item("weights", weights)?;
        Ok(all)
    }

    fn sequences<'py>(
        &self,
        py: Python<'py>,
        request: SampleRequest,
    ) -> PyResult<Bound<'py, PyDict>> {
        let SampleRequest { len, seed, number, steps, .. } = request;
        // Each of the numbers is moved once more on its way.
        let each = 2 * (3 + (O + 2) * size_of::<T>()) as u128;
        check_memory((len as u128 * steps as u128).saturating_mul(each))?;
        let mut drawn = Sequences::<T, O, 1>::new(len, steps);
        let found = py.detach(|| {
            self.sample_sequences(Draw { seed, number }, &mut drawn, &Execution::serial())
        });
        found.map_err(Raised::raised)?;
        let flags = |all: Vec<u8>| -> Vec<bool> { all.into_iter().map(|x| x != 0).collect() };
        let all = PyDict::new(py);
        let shaped = |name: &str, array: Bound<'py, PyAny>, shape: Vec<usize>| {
            all.set_item(name, array.call_method1("reshape", (shape,))?)
        };
        let [rows, one] = [vec![len, steps], vec![len, steps, 1]];
        let seen = drawn.observation.into_flattened();
        let next = drawn.next_observation.into_flattened();
        let actions = drawn.action.into_flattened();
        all.set_item("indices", PyArray1::from_vec(py, drawn.number))?;
        shaped("observations", PyArray1::from_vec(py, seen).into_any(), vec![len, steps, O])?;
        shaped("actions", PyArray1::from_vec(py, actions).into_any(), one)?;
        shaped("rewards", PyArray1::from_vec(py, drawn.reward).into_any(), rows.clone())?;
        for (name, of) in
            [("terminated", drawn.terminated), ("truncated", drawn.truncated), ("mask", drawn.mask)]
        {
            shaped(name, PyArray1::from_vec(py, flags(of)).into_any(), rows.clone())?;
        }
        shaped("next_observations", PyArray1::from_vec(py, next).into_any(), vec![len, O])?;
        Ok(all)
    }

    fn update(
        &mut self,
        numbers: &[u64],
        priorities: &[f64],
        exponent: f64,
    ) -> Result<usize, ReplayError> {
        let priorities: Vec<T> = priorities.iter().map(|&x| T::from_f64(x)).collect();
        ReplayBuffer::update(self, numbers, &priorities, exponent)
    }
}

fn made<T: Number>(observations: usize, capacity: Capacity) -> PyResult<Box<dyn Store<T>>> {
    fn of<T: Number, const O: usize>(capacity: Capacity) -> PyResult<Box<dyn Store<T>>> {
        let replay = ReplayBuffer::<T, O, 1>::new(capacity);
        replay.map(|made| Box::new(made) as Box<dyn Store<T>>).map_err(Raised::raised)
    }
    match observations {
        2 => of::<T, 2>(capacity),
        3 => of::<T, 3>(capacity),
        4 => of::<T, 4>(capacity),
        n => Err(value_error(format!("no environment shows {n} numbers"))),
    }
}

#[pymethods]
impl Buffer {
    /// Room for so many steps of so many environments.
    #[new]
    #[pyo3(signature = (steps, environments, observations, single, priorities, ends=None))]
    fn new(
        steps: usize,
        environments: usize,
        observations: usize,
        single: bool,
        priorities: bool,
        ends: Option<usize>,
    ) -> PyResult<Self> {
        let mut capacity = Capacity::new(steps, environments);
        capacity.priorities = priorities;
        capacity.ends = ends.unwrap_or(capacity.ends);
        let store = if single {
            AnyStore::F32(made(observations, capacity)?)
        } else {
            AnyStore::F64(made(observations, capacity)?)
        };
        Ok(Buffer { store: CheckedMutex::new(store) })
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        let store = self.store.lock(py)?;
        let len = with_store!(&*store, store => store.len());
        usize::try_from(len).map_err(|error| value_error(error.to_string()))
    }

    /// Takes what a rollout holds, and what is seen after its last step.
    fn _insert(&self, py: Python<'_>, memory: &Memory, next: &Bound<'_, PyAny>) -> PyResult<()> {
        fn taken<T: Number>(
            store: &mut dyn Store<T>,
            tensors: &mut dyn AnyRollout<T>,
            next: &Bound<'_, PyAny>,
        ) -> PyResult<()> {
            let next = next.call_method0("ravel")?;
            let next = next.cast::<PyArray1<T>>().map_err(|_| {
                value_error(format!("what is seen next must be an array of {}", T::NUMPY))
            })?;
            store.insert(tensors, &next.to_vec()?).map_err(Raised::raised)
        }
        let mut store = self.store.lock(py)?;
        match (&mut *store, &mut *memory.tensors(py)?) {
            (AnyStore::F32(store), AnyTensors::F32(tensors)) => {
                taken(&mut **store, &mut **tensors, next)
            }
            (AnyStore::F64(store), AnyTensors::F64(tensors)) => {
                taken(&mut **store, &mut **tensors, next)
            }
            _ => Err(value_error("the rollout is of another dtype than the buffer".to_owned())),
        }
    }

    /// Draws transitions.
    fn _sample<'py>(
        &self,
        py: Python<'py>,
        request: SampleRequest,
    ) -> PyResult<Bound<'py, PyDict>> {
        let store = self.store.lock(py)?;
        with_store!(&*store, store => store.sample(py, request))
    }

    /// Draws stretches of steps.
    fn _sequences<'py>(
        &self,
        py: Python<'py>,
        request: SampleRequest,
    ) -> PyResult<Bound<'py, PyDict>> {
        let store = self.store.lock(py)?;
        with_store!(&*store, store => store.sequences(py, request))
    }

    /// Changes priorities. Gives how many.
    fn _update(
        &self,
        py: Python<'_>,
        numbers: PyReadonlyArray1<'_, u64>,
        priorities: PyReadonlyArray1<'_, f64>,
        exponent: f64,
    ) -> PyResult<usize> {
        let (numbers, priorities) = (numbers.to_vec()?, priorities.to_vec()?);
        let mut store = self.store.lock(py)?;
        let changed =
            with_store!(&mut *store, store => store.update(&numbers, &priorities, exponent));
        changed.map_err(Raised::raised)
    }
}
