//! The audit of energy traces.

use libration_energy::{EnergyTrace, Requirement, audit, page};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::error::value_error;

/// A trace: its title, time step, times and energies.
type Trace<'py> = (String, Option<f64>, PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);

/// Audits energies. Gives JSON, whether all verdicts are good, and a page.
#[pyfunction]
pub(crate) fn _audit_energy(
    traces: Vec<Trace<'_>>,
    tolerance: Option<f64>,
    horizon: Option<f64>,
    scale: Option<f64>,
    invocation: String,
) -> PyResult<(String, bool, String)> {
    let mut all = Vec::with_capacity(traces.len());
    for (title, dt, times, energies) in &traces {
        let (times, energies) = (times.as_slice()?.to_vec(), energies.as_slice()?.to_vec());
        all.push(EnergyTrace { title: title.clone(), dt: *dt, times, energies });
    }
    let wrong = |error: &dyn core::fmt::Display| value_error(error.to_string());
    let mut report =
        audit(&all, Requirement { tolerance, horizon, scale }).map_err(|error| wrong(&error))?;
    report.repeat_command = invocation;
    let json = serde_json::to_string(&report).map_err(|error| wrong(&error))?;
    Ok((json, report.holds(), page(&report)))
}
