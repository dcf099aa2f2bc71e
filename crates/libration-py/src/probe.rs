//! The audit of a step that is a Python function.

use libration::linear::Matrix;
use libration_probe::{
    BlackBox, BlackBoxError, Description, FirstDifference, MeasuredGains, ServoIntegrator,
    ServosDescription, gains, gains_page, jacobian, page, probe,
};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::{unknown, value_error};

/// A simulator of Python functions on arrays of rows.
struct PythonStep<'py> {
    py: Python<'py>,
    step: Bound<'py, PyAny>,
    observe: Option<Bound<'py, PyAny>>,
    energy: Option<Bound<'py, PyAny>>,
    restart: Option<Bound<'py, PyAny>>,
    set_gains: Option<Bound<'py, PyAny>>,
    is_batched: bool,
    /// The exception of a function, to be raised again.
    raised: Option<PyErr>,
}

impl<'py> PythonStep<'py> {
    fn array(&self, matrix: &Matrix) -> PyResult<Bound<'py, PyAny>> {
        array(self.py, matrix)
    }

    fn called<T>(&mut self, result: PyResult<T>) -> Result<T, BlackBoxError> {
        result.map_err(|error| {
            let text = error.to_string();
            self.raised.get_or_insert(error);
            BlackBoxError::Failed(text)
        })
    }
}

fn array<'py>(py: Python<'py>, matrix: &Matrix) -> PyResult<Bound<'py, PyAny>> {
    let flat = PyArray1::from_slice(py, matrix.entries());
    Ok(flat.reshape([matrix.rows(), matrix.columns()])?.into_any())
}

fn matrix(found: &Bound<'_, PyAny>) -> PyResult<Matrix> {
    let found: PyReadonlyArray2<'_, f64> = found.extract()?;
    let [rows, columns] = [found.shape()[0], found.shape()[1]];
    let entries = found.as_slice()?;
    Ok(Matrix::from_fn(rows, columns, |i, j| entries[i * columns + j]))
}

impl BlackBox for PythonStep<'_> {
    fn step(
        &mut self,
        states: &Matrix,
        actions: &Matrix,
        dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        let call = || matrix(&self.step.call1((self.array(states)?, self.array(actions)?, dt))?);
        let result = call();
        self.called(result)
    }

    fn is_batched(&self) -> bool {
        self.is_batched
    }

    fn observe(&mut self, states: &Matrix) -> Result<Option<Matrix>, BlackBoxError> {
        let Some(observe) = &self.observe else { return Ok(None) };
        let call = || matrix(&observe.call1((self.array(states)?,))?);
        let result = call();
        self.called(result).map(Some)
    }

    fn energies(&mut self, states: &Matrix) -> Result<Option<Vec<f64>>, BlackBoxError> {
        let Some(energy) = &self.energy else { return Ok(None) };
        let call = || {
            let found = energy.call1((self.array(states)?,))?;
            let found: PyReadonlyArray1<'_, f64> = found.extract()?;
            Ok(found.as_slice()?.to_vec())
        };
        let result = call();
        self.called(result).map(Some)
    }

    fn set_gains(&mut self, kp: &[f64], kv: &[f64]) -> Result<bool, BlackBoxError> {
        let Some(set_gains) = &self.set_gains else { return Ok(false) };
        let result = set_gains.call1((kp.to_vec(), kv.to_vec())).map(|_| true);
        self.called(result)
    }

    fn restart(&mut self) -> Result<bool, BlackBoxError> {
        let Some(restart) = &self.restart else { return Ok(false) };
        let result = restart.call0().map(|_| true);
        self.called(result)
    }
}

/// Audits a step. Gives JSON, whether the step has no fault, and a page.
#[pyfunction]
pub(crate) fn _probe(
    py: Python<'_>,
    description: &str,
    step: Bound<'_, PyAny>,
    observe: Option<Bound<'_, PyAny>>,
    energy: Option<Bound<'_, PyAny>>,
    restart: Option<Bound<'_, PyAny>>,
    batched: bool,
) -> PyResult<(String, bool, String)> {
    let wrong = |error: &dyn core::fmt::Display| value_error(error.to_string());
    let subject = Description::parse(description).and_then(Description::subject);
    let subject = subject.map_err(|error| wrong(&error))?;
    let mut black_box = PythonStep {
        py,
        step,
        observe,
        energy,
        restart,
        set_gains: None,
        is_batched: batched,
        raised: None,
    };
    match probe(&mut black_box, &subject) {
        Ok(report) => {
            let json = serde_json::to_string(&report).map_err(|error| wrong(&error))?;
            Ok((json, report.holds(), page(&report)))
        }
        Err(error) => Err(black_box.raised.unwrap_or_else(|| wrong(&error))),
    }
}

/// The first difference: index, both numbers, units in the last place, and how many numbers differ.
type Difference = (Vec<usize>, f64, f64, Option<u64>, usize);

/// The first difference of two contiguous recordings with this shape.
#[pyfunction]
pub(crate) fn _first_difference(
    first: PyReadonlyArray1<'_, f64>,
    second: PyReadonlyArray1<'_, f64>,
    shape: Vec<usize>,
) -> PyResult<Option<Difference>> {
    let found = FirstDifference::find(first.as_slice()?, second.as_slice()?, &shape);
    Ok(found.map(|d| (d.index, d.first, d.second, d.ulps, d.differing)))
}

/// Whether the gains of servos hold, in a step if one is given. Gives JSON and a page.
#[pyfunction]
pub(crate) fn _gains(
    py: Python<'_>,
    description: &str,
    dt: f64,
    substeps: u32,
    integrator: &str,
    step: Option<Bound<'_, PyAny>>,
    set_gains: Option<Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let wrong = |error: &dyn core::fmt::Display| value_error(error.to_string());
    let described: ServosDescription =
        serde_json::from_str(description).map_err(|error| wrong(&error))?;
    let servos = described.servos().map_err(|error| wrong(&error))?;
    let found = ServoIntegrator::from_name(integrator);
    let found = found.ok_or_else(|| {
        let names: Vec<&str> = ServoIntegrator::names().collect();
        unknown("integrator", integrator, names)
    })?;
    let mut report = gains(&servos, dt, substeps, found, described.notes)
        .with_inert_servos(described.saturated, described.idle)
        .with_other_forces(described.other_forces);
    if let (Some(step), Some(description)) = (step, described.step) {
        let subject = description.subject().map_err(|error| wrong(&error))?;
        let mut black_box = PythonStep {
            py,
            step,
            observe: None,
            energy: None,
            restart: None,
            set_gains,
            is_batched: true,
            raised: None,
        };
        match MeasuredGains::measure(&mut black_box, &subject, &described.servos, substeps) {
            Ok(measured) => report = report.with_measured(measured),
            Err(error) => return Err(black_box.raised.unwrap_or_else(|| wrong(&error))),
        }
    }
    let json = serde_json::to_string(&report).map_err(|error| wrong(&error))?;
    Ok((json, gains_page(&report)))
}

/// The Jacobian of a function of rows of points, values × variables, and estimated errors of its entries.
#[pyfunction]
pub(crate) fn _jacobian<'py>(
    py: Python<'py>,
    function: &Bound<'py, PyAny>,
    z: PyReadonlyArray1<'py, f64>,
    scale: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let rows = |points: &Matrix| matrix(&function.call1((array(py, points)?,))?);
    let found = jacobian(rows, z.as_slice()?, scale.as_slice()?, 0.0)?;
    Ok((array(py, &found.values)?, array(py, &found.errors)?))
}
