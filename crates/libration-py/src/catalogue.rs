//! What there is to choose from.

use libration::Method;
use libration::catalog::ENTRIES;
use libration_analyze::analyze::Stepping;
use libration_lab::STUDIES;
use pyo3::prelude::*;

use crate::asked::{SystemTold, system};

/// A parameter: its name, unit, meaning and default.
type Parameter = (&'static str, &'static str, &'static str, f64);

/// A system: its name, what it is, its least and largest number of dimensions, and its parameters.
type Entry = (&'static str, &'static str, usize, usize, Vec<Parameter>);

/// All systems.
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

/// All integrators, with what they are; the last are exact steps of linear systems.
#[pyfunction]
pub(crate) fn _integrators() -> Vec<(&'static str, &'static str)> {
    let methods = Method::ALL.map(|method| (method.name(), method.summary()));
    let exact = (Stepping::EXACT, libration::integrator::Exact::SUMMARY);
    methods.into_iter().chain([exact]).collect()
}

/// All studies of the laboratory, with the questions that they answer.
#[pyfunction]
pub(crate) fn _studies() -> Vec<(&'static str, &'static str)> {
    STUDIES.studies.iter().map(|study| (study.name(), study.question())).collect()
}

/// All parameters of a system, those that were not given as well.
#[pyfunction]
pub(crate) fn _parameters(told: SystemTold) -> PyResult<Vec<(&'static str, f64)>> {
    let (system, actuation) = system(&told)?;
    Ok(actuation.parameters(system))
}
