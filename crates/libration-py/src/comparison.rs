//! Comparisons of integrators on a motion.

use libration_analyze::comparison::{ComparisonError, ComparisonRequest, compare};
use libration_work::{Silent, Work};
use pyo3::prelude::*;
use serde_json::json;

use crate::background::run_in_background;
use crate::equations::{AnySystem, any_system};
use crate::error::{Raised, interrupted, value_error};

impl Raised for ComparisonError {
    fn raised(self) -> PyErr {
        match self {
            ComparisonError::Interrupted => interrupted(),
            error => value_error(error.to_string()),
        }
    }
}

/// Compares integrators on a system by equations or of the catalogue. Gives JSON.
#[pyfunction]
pub(crate) fn _compare_integrators(
    py: Python<'_>,
    system: AnySystem,
    tolerance: f64,
    horizon: f64,
) -> PyResult<String> {
    let request = ComparisonRequest { system: any_system(&system)?, horizon, tolerance };
    let done =
        run_in_background(py, |stop| compare(&Work::new(&Silent, stop), &request), |_| Ok(()))?;
    Ok(json!(done.map_err(Raised::raised)?).to_string())
}
