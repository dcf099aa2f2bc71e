//! Bodies for Python.

use std::path::Path;

use libration::Method;
use libration::bodies::{
    Bodies, BodiesError, Body, BodyIntegrator, InitialConditions, PairPotential,
};
use libration::ensemble::{Execution, InsufficientMemory};
use libration_analyze::bodies::{BodiesRequest, simulate};
use libration_analyze::export::{ExportError, Rows};
use libration_analyze::trajectory::TrajectoryError;
use libration_settings::bodies_file::{self, NamedBodies};
use libration_settings::equations::explanation;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use serde_json::json;

use crate::background::run_in_background;
use crate::error::{Raised, unknown, value_error};

/// Bodies as Python has them. Positions and velocities are flat: three numbers for each body.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct BodyTable {
    name: String,
    names: Vec<String>,
    masses: Vec<f64>,
    radii: Vec<f64>,
    charges: Vec<f64>,
    pair_potential: Option<String>,
    parameters: Vec<(String, f64)>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    gravitational_constant: f64,
    softening: f64,
}

/// Options of a simulation.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct BodyOptions {
    integrator: String,
    dt: f64,
    steps: u64,
    every: Option<u64>,
    compensated: bool,
    predict: bool,
    adaptive: bool,
    threads: usize,
}

impl Raised for BodiesError {
    fn raised(self) -> PyErr {
        value_error(self.to_string())
    }
}

impl BodyTable {
    fn read(self) -> PyResult<NamedBodies> {
        let count = self.masses.len();
        let lengths = [
            ("names", self.names.len(), count),
            ("radii", self.radii.len(), count),
            ("charges", self.charges.len(), count),
            ("positions", self.positions.len(), 3 * count),
            ("velocities", self.velocities.len(), 3 * count),
        ];
        if let Some((name, found, wanted)) =
            lengths.into_iter().find(|(_, found, wanted)| found != wanted)
        {
            let message =
                format!("{name} has {found} numbers for {count} bodies; expected {wanted}");
            return Err(value_error(message));
        }
        let three = |all: &[f64], i: usize| -> [f64; 3] {
            core::array::from_fn(|axis| all.get(3 * i + axis).copied().unwrap_or(f64::NAN))
        };
        let body = |i: usize| Body {
            mass: self.masses[i],
            position: three(&self.positions, i),
            velocity: three(&self.velocities, i),
            radius: self.radii.get(i).copied().unwrap_or(0.0),
            charge: self.charges.get(i).copied().unwrap_or(0.0),
        };
        let all: Vec<Body> = (0..self.masses.len()).map(body).collect();
        let bodies = Bodies::new(&all)
            .and_then(|bodies| bodies.gravitational_constant(self.gravitational_constant))
            .and_then(|bodies| bodies.softening(self.softening));
        let mut bodies = bodies.map_err(Raised::raised)?;
        if let Some(text) = &self.pair_potential {
            let potential = PairPotential::new(text, &self.parameters).map_err(|error| {
                let text = explanation(&error);
                value_error(text.replacen(PairPotential::KEY, "pair_potential", 1))
            })?;
            bodies = bodies.pair_potential(potential).map_err(Raised::raised)?;
        }
        bodies.ensure_effects().map_err(Raised::raised)?;
        Ok(NamedBodies { name: self.name, bodies, names: self.names })
    }
}

/// The table of bodies, as keywords of the class.
fn table<'py>(py: Python<'py>, system: &NamedBodies) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let NamedBodies { name, bodies, names } = system;
    let flat = |of: fn(Body) -> [f64; 3]| -> Vec<f64> { bodies.iter().flat_map(of).collect() };
    dict.set_item("name", name)?;
    dict.set_item("names", names)?;
    dict.set_item("masses", PyArray1::from_slice(py, bodies.masses()))?;
    dict.set_item("radii", PyArray1::from_slice(py, bodies.radii()))?;
    dict.set_item("charges", PyArray1::from_slice(py, bodies.charges()))?;
    dict.set_item("pair_potential", bodies.pairs().map(PairPotential::text))?;
    let parameters = bodies.pairs().map(PairPotential::parameters).unwrap_or_default();
    dict.set_item("parameters", parameters.to_vec().into_py_dict(py)?)?;
    dict.set_item("positions", PyArray1::from_vec(py, flat(|body| body.position)))?;
    dict.set_item("velocities", PyArray1::from_vec(py, flat(|body| body.velocity)))?;
    dict.set_item("gravitational_constant", bodies.constant())?;
    dict.set_item("softening", bodies.softening_length())?;
    Ok(dict)
}

/// Raises the error of invalid bodies.
#[pyfunction]
pub(crate) fn _check_bodies(system: BodyTable) -> PyResult<()> {
    system.read().map(|_| ())
}

/// Published initial conditions.
#[pyfunction]
pub(crate) fn _named_bodies(
    py: Python<'_>,
    name: &str,
    count: usize,
    seed: u64,
) -> PyResult<Py<PyDict>> {
    let published = InitialConditions::from_name(name).ok_or_else(|| {
        unknown("name", name, InitialConditions::ALL.map(InitialConditions::name))
    })?;
    let bodies = published.bodies(count, seed).map_err(Raised::raised)?;
    let names = match published.body_names() {
        [] => (0..bodies.count()).map(|i| i.to_string()).collect(),
        names => names.iter().map(|&name| name.to_owned()).collect(),
    };
    let system = NamedBodies { name: name.to_owned(), bodies, names };
    Ok(table(py, &system)?.unbind())
}

/// The bodies of a file.
#[pyfunction]
pub(crate) fn _read_bodies(py: Python<'_>, path: &str) -> PyResult<Py<PyDict>> {
    let text = bodies_file::read_text(Path::new(path))?;
    let system = NamedBodies::parse(&text, path).map_err(Raised::raised)?;
    Ok(table(py, &system)?.unbind())
}

/// States of the samples: six numbers for each body.
#[derive(Default)]
struct Samples {
    times: Vec<f64>,
    states: Vec<f64>,
}

impl Rows<f64> for Samples {
    fn row(&mut self, index: &[u64], t: f64, values: &[f64]) -> Result<(), ExportError> {
        if index.first() == Some(&0) {
            self.times.push(t);
        }
        self.states.extend_from_slice(values);
        Ok(())
    }
}

/// A motion: the audit as JSON, the times of the samples, and the states.
type Motion<'py> = (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Simulates bodies.
#[pyfunction]
pub(crate) fn _simulate_bodies<'py>(
    py: Python<'py>,
    system: BodyTable,
    options: BodyOptions,
) -> PyResult<Motion<'py>> {
    let BodyOptions { integrator, dt, steps, every, compensated, predict, adaptive, threads } =
        options;
    let integrator = BodyIntegrator::from_name(&integrator).ok_or_else(|| {
        let own = Method::ALL.map(|method| method.name().to_owned()).into_iter();
        let known: Vec<String> =
            own.chain(BodyIntegrator::wisdom_holman().map(BodyIntegrator::name)).collect();
        unknown("integrator", &integrator, known.iter().map(String::as_str))
    })?;
    let request = BodiesRequest {
        system: system.read()?,
        integrator,
        dt,
        steps,
        every,
        is_compensated: compensated,
        is_adaptive: adaptive,
        is_predicted: predict,
        execution: Execution::serial().threads(threads).map_err(Raised::raised)?,
    };
    InsufficientMemory::check(u128::from(request.rows()) * 48)
        .map_err(|error| TrajectoryError::Memory(error).raised())?;
    let mut samples = Samples::default();
    let audit = run_in_background(py, |stop| simulate(&request, &mut samples, stop), |_| Ok(()))?;
    let audit = audit.map_err(Raised::raised)?;
    let Samples { times, states } = samples;
    Ok((json!(audit).to_string(), PyArray1::from_vec(py, times), PyArray1::from_vec(py, states)))
}
