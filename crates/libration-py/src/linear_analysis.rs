//! The function `analyze` for linear plants in Python.

use libration_advise::linear::{self, AnalysisFile};
use libration_analyze::linear_analysis;
use pyo3::prelude::*;

use crate::background::run_in_background;
use crate::error::{Raised, value_error};
use crate::request::stepping;

/// Analyses the plant or the loop of the text of a request file. Gives JSON.
#[pyfunction]
pub(crate) fn _analyze_linear(
    py: Python<'_>,
    config: &str,
    dt: Option<f64>,
    integrator: Option<&str>,
) -> PyResult<String> {
    let stepping = integrator.map(stepping).transpose()?;
    let mut contents = AnalysisFile::default();
    let request = linear::parse_changed(config, "config.toml", |file| {
        contents = AnalysisFile::complete(file);
    });
    let request = request.map_err(Raised::raised)?;
    let request = contents.request(&request, dt, stepping);
    let request = request.map_err(|error| value_error(error.to_string()))?;
    let done = run_in_background(py, |stop| linear_analysis::analyze(&request, stop), |_| Ok(()))?;
    let analysis = done.map_err(Raised::raised)?;
    serde_json::to_string(&analysis).map_err(|error| value_error(error.to_string()))
}
