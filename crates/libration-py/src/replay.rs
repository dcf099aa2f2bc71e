//! Replay buffers as Python holds them.

use libration::ensemble::Execution;
use libration::replay::{Capacity, Columns, Draw, Lookahead, ReplayBuffer, ReplayError, Sequences};
use libration::rl::RolloutTensors;
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
    buffer: CheckedMutex<AnyBuffer>,
}

/// A buffer of either float type.
enum AnyBuffer {
    F32(ReplayBuffer<f32>),
    F64(ReplayBuffer<f64>),
}

/// Evaluates an expression for the buffer of either float type.
macro_rules! with_buffer {
    ($any:expr, $buffer:ident => $work:expr) => {
        match $any {
            AnyBuffer::F32($buffer) => $work,
            AnyBuffer::F64($buffer) => $work,
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

/// Inserts a rollout, and `next`, the observations after its last step.
fn insert<T: Number>(
    buffer: &mut ReplayBuffer<T>,
    rollout: &dyn RolloutTensors<T>,
    next: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let next = next.call_method0("ravel")?;
    let next = next
        .cast::<PyArray1<T>>()
        .map_err(|_| value_error(format!("what is seen next must be an array of {}", T::NUMPY)))?;
    buffer.insert(rollout, &next.to_vec()?, &Execution::serial()).map_err(Raised::raised)
}

/// Draws transitions: `observations` and `next_observations` are `(B, n)`, `actions` `(B, m)`, and all others `(B,)`.
fn sample<'py, T: Number>(
    py: Python<'py>,
    buffer: &ReplayBuffer<T>,
    request: SampleRequest,
) -> PyResult<Bound<'py, PyDict>> {
    let SampleRequest { len, seed, number, steps, gamma, correction } = request;
    let [observed, acted] = buffer.sizes();
    let each = (2 * observed as u128 + acted as u128 + 3) * size_of::<T>() as u128;
    check_memory((len as u128).saturating_mul(8 + 2 + each))?;
    let numbers: Bound<'py, Array<u64, 1>> = allocate(py, [len])?;
    let rows = |each| allocate::<T, 2>(py, [len, each]);
    let (seen, actions, next) = (rows(observed)?, rows(acted)?, rows(observed)?);
    let column = || allocate::<T, 1>(py, [len]);
    let (rewards, discounts, weights) = (column()?, column()?, column()?);
    let flags = || allocate::<bool, 1>(py, [len]);
    let (over, cut) = (flags()?, flags()?);
    let mut columns = Columns {
        number: view_mut(&numbers),
        observation: view_mut(&seen),
        action: view_mut(&actions),
        reward: view_mut(&rewards),
        next_observation: view_mut(&next),
        terminated: bytes_of(&over),
        truncated: bytes_of(&cut),
        discount: view_mut(&discounts),
        weight: view_mut(&weights),
    };
    let (draw, ahead) = (Draw { seed, number }, Lookahead { steps, discount: gamma });
    let serial = Execution::serial();
    let drawn = py.detach(|| match correction {
        Some(beta) => buffer.sample_prioritised(draw, ahead, beta, &mut columns, &serial),
        None => buffer.sample(draw, ahead, &mut columns, &serial),
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

/// Draws sequences: `observations` are `(B, T, n)`, `actions` `(B, T, m)`, `next_observations` `(B, n)`, `indices` `(B,)`, and all
/// others `(B, T)`.
fn sequences<'py, T: Number>(
    py: Python<'py>,
    buffer: &ReplayBuffer<T>,
    request: SampleRequest,
) -> PyResult<Bound<'py, PyDict>> {
    let SampleRequest { len, seed, number, steps, .. } = request;
    let [observed, acted] = buffer.sizes();
    // Each of the numbers is moved once more on its way.
    let each = 2 * (3 + (observed as u128 + acted as u128 + 1) * size_of::<T>() as u128);
    check_memory((len as u128 * steps as u128).saturating_mul(each))?;
    let mut drawn = Sequences::<T>::new(len, steps, [observed, acted]);
    let found = py.detach(|| {
        buffer.sample_sequences(Draw { seed, number }, &mut drawn, &Execution::serial())
    });
    found.map_err(Raised::raised)?;
    let flags = |all: Vec<u8>| -> Vec<bool> { all.into_iter().map(|x| x != 0).collect() };
    let all = PyDict::new(py);
    let shaped = |name: &str, array: Bound<'py, PyAny>, shape: Vec<usize>| {
        all.set_item(name, array.call_method1("reshape", (shape,))?)
    };
    let numbers = |numbers: Vec<T>| PyArray1::from_vec(py, numbers).into_any();
    all.set_item("indices", PyArray1::from_vec(py, drawn.number))?;
    shaped("observations", numbers(drawn.observation), vec![len, steps, observed])?;
    shaped("actions", numbers(drawn.action), vec![len, steps, acted])?;
    shaped("rewards", numbers(drawn.reward), vec![len, steps])?;
    for (name, of) in
        [("terminated", drawn.terminated), ("truncated", drawn.truncated), ("mask", drawn.mask)]
    {
        shaped(name, PyArray1::from_vec(py, flags(of)).into_any(), vec![len, steps])?;
    }
    shaped("next_observations", numbers(drawn.next_observation), vec![len, observed])?;
    Ok(all)
}

/// Changes priorities. Gives how many.
fn update<T: Number>(
    buffer: &mut ReplayBuffer<T>,
    numbers: &[u64],
    priorities: &[f64],
    exponent: f64,
) -> Result<usize, ReplayError> {
    let priorities: Vec<T> = priorities.iter().map(|&x| T::from_f64(x)).collect();
    buffer.update(numbers, &priorities, exponent)
}

#[pymethods]
impl Buffer {
    /// Room for so many steps of so many environments, with these numbers of observations and actions.
    #[new]
    #[pyo3(signature = (steps, environments, sizes, single, priorities, ends=None))]
    fn new(
        steps: usize,
        environments: usize,
        sizes: [usize; 2],
        single: bool,
        priorities: bool,
        ends: Option<usize>,
    ) -> PyResult<Self> {
        let mut capacity = Capacity::new(steps, environments);
        capacity.priorities = priorities;
        capacity.ends = ends.unwrap_or(capacity.ends);
        let buffer = match single {
            true => ReplayBuffer::new(sizes, capacity).map(AnyBuffer::F32),
            false => ReplayBuffer::new(sizes, capacity).map(AnyBuffer::F64),
        };
        Ok(Buffer { buffer: CheckedMutex::new(buffer.map_err(Raised::raised)?) })
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        let buffer = self.buffer.lock(py)?;
        let len = with_buffer!(&*buffer, buffer => buffer.len());
        usize::try_from(len).map_err(|error| value_error(error.to_string()))
    }

    /// Takes what a rollout holds, and what is seen after its last step.
    fn _insert(&self, py: Python<'_>, memory: &Memory, next: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut buffer = self.buffer.lock(py)?;
        match (&mut *buffer, &*memory.tensors(py)?) {
            (AnyBuffer::F32(buffer), AnyTensors::F32(tensors)) => insert(buffer, &**tensors, next),
            (AnyBuffer::F64(buffer), AnyTensors::F64(tensors)) => insert(buffer, &**tensors, next),
            _ => Err(value_error("the rollout is of another dtype than the buffer".to_owned())),
        }
    }

    /// Draws transitions.
    fn _sample<'py>(
        &self,
        py: Python<'py>,
        request: SampleRequest,
    ) -> PyResult<Bound<'py, PyDict>> {
        let buffer = self.buffer.lock(py)?;
        with_buffer!(&*buffer, buffer => sample(py, buffer, request))
    }

    /// Draws stretches of steps.
    fn _sequences<'py>(
        &self,
        py: Python<'py>,
        request: SampleRequest,
    ) -> PyResult<Bound<'py, PyDict>> {
        let buffer = self.buffer.lock(py)?;
        with_buffer!(&*buffer, buffer => sequences(py, buffer, request))
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
        let mut buffer = self.buffer.lock(py)?;
        let changed =
            with_buffer!(&mut *buffer, buffer => update(buffer, &numbers, &priorities, exponent));
        changed.map_err(Raised::raised)
    }
}
