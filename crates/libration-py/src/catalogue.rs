//! Systems, integrators and studies for Python.

use libration::catalog::ENTRIES;
use libration::equations::Definitions;
use libration::integrator::{RungeKuttaTable, SplittingTable};
use libration::{ImplicitMethod, Method};
use libration_analyze::Stepping;
use libration_env::environments::task_expressions;
use libration_lab::STUDIES;
use pyo3::prelude::*;

use crate::error::unknown;
use crate::request::{self, SystemRequest};

/// A parameter: its name, unit, meaning and default.
type Parameter = (&'static str, &'static str, &'static str, f64);

/// A system: its name, what it is, its least and largest number of dimensions, and its parameters.
type Entry = (&'static str, &'static str, usize, usize, Vec<Parameter>);

/// Returns all systems.
#[pyfunction]
pub(crate) fn _systems() -> Vec<Entry> {
    let each = ENTRIES.into_iter().map(|entry| {
        let parameters =
            entry.parameters.iter().map(|p| (p.name, p.unit, p.summary, p.default)).collect();
        let (least, most) = (*entry.dimensions.start(), *entry.dimensions.end());
        (entry.name, entry.summary, least, most, parameters)
    });
    each.collect()
}

/// Returns all explicit integrators with descriptions; the last one is exact steps of linear systems.
#[pyfunction]
pub(crate) fn _integrators() -> Vec<(&'static str, &'static str)> {
    let methods = Method::ALL.map(|method| (method.name(), method.summary()));
    let exact = (Stepping::EXACT, libration::integrator::Exact::SUMMARY);
    methods.into_iter().chain([exact]).collect()
}

/// Returns all published splitting methods: name, description, source.
#[pyfunction]
pub(crate) fn _splitting_methods() -> Vec<(&'static str, &'static str, &'static str)> {
    let tables = SplittingTable::ALL.into_iter().flatten();
    tables.map(|table| (table.name, table.summary, table.source)).collect()
}

/// Returns all published Runge–Kutta methods: name, description, source.
#[pyfunction]
pub(crate) fn _runge_kutta_methods() -> Vec<(&'static str, &'static str, &'static str)> {
    let tables = RungeKuttaTable::ALL.into_iter().flatten();
    tables.map(|table| (table.name, table.summary, table.source)).collect()
}

/// Returns all implicit integrators with descriptions.
#[pyfunction]
pub(crate) fn _implicit_integrators() -> Vec<(&'static str, &'static str)> {
    ImplicitMethod::ALL.map(|method| (method.name(), method.summary())).to_vec()
}

/// Returns all studies with their questions.
#[pyfunction]
pub(crate) fn _studies() -> Vec<(&'static str, &'static str)> {
    STUDIES.studies.iter().map(|study| (study.name(), study.question())).collect()
}

/// Accelerations of coordinates, and names of commands.
type Commanded = (Vec<(String, String)>, Vec<String>);

/// Returns the accelerations of a system with commands, and their names: of the parameters only whether there is a mass counts.
#[pyfunction]
pub(crate) fn _commanded(system: SystemRequest) -> PyResult<Commanded> {
    let (system, actuation) = request::system(&system)?;
    let definitions = Definitions::of_catalogue(system, actuation).commanded(actuation);
    Ok((definitions.accelerations, definitions.inputs))
}

/// Observations, reward and comparisons that end an episode.
type TaskTexts = (Vec<String>, String, Vec<String>);

/// Returns the expressions of a task of the engine, whose numbers are parameters.
#[pyfunction]
pub(crate) fn _task_expressions(name: &str) -> PyResult<TaskTexts> {
    let found = task_expressions(name);
    let found = found.ok_or_else(|| unknown("task", name, ["regulate", "swing-up", "track"]))?;
    Ok((found.observe, found.reward, found.terminated))
}

/// Returns all parameters of a system, with defaults.
#[pyfunction]
pub(crate) fn _parameters(system: SystemRequest) -> PyResult<Vec<(&'static str, f64)>> {
    let (system, actuation) = request::system(&system)?;
    Ok(actuation.parameters(system))
}
