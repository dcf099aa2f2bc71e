//! The functions `simulate` and `analyze` for Python.

use half::{bf16, f16};
use libration::control::clock::Recorded;
use libration_analyze::newton_residual::NewtonResidual;
use libration_analyze::trajectory;
use libration_analyze::trajectory::{Divergence, EnsembleOptions, FloatType, Outcome, Request};
use libration_analyze::{Criteria, Stepping, Timing};
use libration_data::Values;
use libration_settings::equations::EquationSystem;
use libration_settings::limits;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::run_in_background;
use crate::equations::{AnySystem, any_system};
use crate::error::{Raised, keywords, unknown, value_error};
use crate::request::{Loop, stepping, warn_of};

/// Options of the rows of a trajectory.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Rows {
    steps: i64,
    dtype: String,
    every: u64,
    count: Option<usize>,
    spread: f64,
    threads: usize,
    seed: u64,
    time_stamps: Option<Vec<f64>>,
}

impl Rows {
    /// The request for rows of a system.
    fn request(
        self,
        system: EquationSystem,
        stepping: Stepping,
        timing: Timing,
        dt: f64,
    ) -> PyResult<Request> {
        let (float, ensemble, steps) = (self.float()?, self.ensemble(), self.steps()?);
        let Rows { every, seed, time_stamps, .. } = self;
        let record = time_stamps.map(|stamps| {
            Recorded::steps_in(&stamps, dt)
                .map_err(|error| value_error(format!("time_stamps: {error}")))
        });
        let record = record.transpose()?;
        Ok(Request { system, stepping, float, dt, steps, every, ensemble, timing, record, seed })
    }

    fn float(&self) -> PyResult<FloatType> {
        FloatType::from_name(&self.dtype)
            .ok_or_else(|| unknown("dtype", &self.dtype, FloatType::ALL.map(FloatType::name)))
    }

    fn ensemble(&self) -> Option<EnsembleOptions> {
        let Rows { spread, threads, .. } = *self;
        let of = |count| EnsembleOptions { count, spread, threads, instructions: None };
        self.count.map(of)
    }

    fn steps(&self) -> PyResult<u64> {
        limits::trajectory_steps("steps", self.steps.into()).map_err(value_error)
    }
}

/// Options of an analysis.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct AnalysisOptions {
    steps: Option<i64>,
    max_drift: Option<f64>,
    max_amplitude: Option<f64>,
    max_error: Option<f64>,
}

/// Simulates. Gives columns, their units, and how it ended.
#[pyfunction]
pub(crate) fn _simulate<'py>(
    py: Python<'py>,
    system: AnySystem,
    step: (String, f64),
    looped: Loop,
    rows: Rows,
) -> PyResult<Simulated<'py>> {
    let (system, (integrator, dt)) = (any_system(&system)?, step);
    let stepping = stepping(&integrator)?;
    let request = rows.request(system, stepping, looped.timing()?, dt)?;
    warn_of(py, request.caveat())?;
    let done =
        run_in_background(py, |stop| trajectory::simulate_until(&request, stop), |_| Ok(()))?;
    converted(py, done.map_err(Raised::raised)?)
}

/// Columns, their units, and how a simulation ended.
type Simulated<'py> = (Bound<'py, PyDict>, Bound<'py, PyDict>, Bound<'py, PyDict>);

fn converted(py: Python<'_>, trajectory: trajectory::Trajectory) -> PyResult<Simulated<'_>> {
    let trajectory::Trajectory { table, outcome } = trajectory;
    let (columns, units) = (PyDict::new(py), PyDict::new(py));
    for column in table.into_columns() {
        units.set_item(&*column.name, &*column.unit)?;
        columns.set_item(&*column.name, array(py, column.values)?)?;
    }
    Ok((columns, units, ended(py, &outcome)?))
}

/// Numbers as an array, which is the memory that they are in where NumPy has the type.
pub(crate) fn array<'py>(py: Python<'py>, values: Values<'static>) -> PyResult<Bound<'py, PyAny>> {
    Ok(match values {
        Values::U64(x) => PyArray1::from_vec(py, x.into_owned()).into_any(),
        Values::U32(x) => PyArray1::from_vec(py, x.into_owned()).into_any(),
        Values::F64(x) => PyArray1::from_vec(py, x.into_owned()).into_any(),
        Values::F32(x) => PyArray1::from_vec(py, x.into_owned()).into_any(),
        Values::F16(x) => {
            let halves: Vec<f32> = x.iter().copied().map(f16::to_f32).collect();
            PyArray1::from_vec(py, halves).call_method1("astype", ("float16",))?
        }
        Values::Bf16(x) => {
            let exact: Vec<f32> = x.iter().copied().map(bf16::to_f32).collect();
            PyArray1::from_vec(py, exact).into_any()
        }
        Values::Bool(x) => {
            let flags: Vec<bool> = x.iter().map(|&flag| flag != 0).collect();
            PyArray1::from_vec(py, flags).into_any()
        }
        Values::Lists(_, of) => array(py, *of)?,
    })
}

fn ended<'py>(py: Python<'py>, outcome: &Outcome) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    match outcome {
        Outcome::Complete => {}
        Outcome::Iterated(_) => {}
        Outcome::EnergyDiverges { verdict, .. } => dict.set_item("error", &verdict.evidence)?,
        Outcome::Diverged(Divergence { step, t, reason, .. }) => {
            dict.set_item("step", step)?;
            dict.set_item("t", t)?;
            dict.set_item("reason", keywords(reason))?;
        }
        Outcome::NotFinite { count, first, reason, .. } => {
            dict.set_item("count", count)?;
            dict.set_item("first", first)?;
            if let Some(reason) = reason {
                dict.set_item("reason", keywords(reason))?;
            }
        }
    }
    if let Some(residual) = outcome.newton_residual() {
        let NewtonResidual { largest, step, t, examined, exceeding } = *residual;
        let own = PyDict::new(py);
        own.set_item("largest", largest)?;
        own.set_item("step", step)?;
        own.set_item("t", t)?;
        own.set_item("examined", examined)?;
        own.set_item("exceeding", exceeding)?;
        dict.set_item("newton_residual", own)?;
        if let Some(error) = residual.error() {
            dict.set_item("error", error)?;
        }
    }
    Ok(dict)
}

/// Analyses steps. Gives JSON.
#[pyfunction]
pub(crate) fn _analyze(
    py: Python<'_>,
    system: AnySystem,
    step: (String, f64),
    looped: Loop,
    options: AnalysisOptions,
) -> PyResult<String> {
    let (system, (integrator, dt)) = (any_system(&system)?, step);
    let AnalysisOptions { steps, max_drift, max_amplitude, max_error } = options;
    let criteria =
        [("max_drift", max_drift), ("max_amplitude", max_amplitude), ("max_error", max_error)];
    for (name, value) in criteria {
        if let Some(value) = value {
            crate::request::within(name, &[value], &limits::CRITERION)?;
        }
    }
    let steps = steps.map_or(libration_analyze::DEFAULT_STEPS.into(), i128::from);
    let steps = match system.is_linear() {
        true => limits::forecast_steps("steps", steps),
        // What cannot be forecast is simulated.
        false => limits::steps("steps", steps),
    };
    let request = libration_analyze::Request {
        system,
        stepping: stepping(&integrator)?,
        dt,
        steps: steps.map_err(value_error)?,
        criteria: Criteria { max_drift, max_amplitude, max_error },
        timing: looped.timing()?,
    };
    let done =
        run_in_background(py, |stop| libration_analyze::analyze_until(&request, stop), |_| Ok(()))?;
    let analysis = done.map_err(Raised::raised)?;
    serde_json::to_string(&analysis).map_err(|error| value_error(error.to_string()))
}
