//! Comparisons of integrators on a motion.

use libration::ensemble::dynamics_of;
use libration_analyze::comparison::{ComparisonError, ComparisonRequest, compare};
use libration_work::{Silent, Work};
use pyo3::prelude::*;
use serde_json::json;

use crate::background::run_in_background;
use crate::equations::{EquationText, equations};
use crate::error::{Raised, interrupted, value_error};
use crate::request::Step;

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
    system: Option<EquationText>,
    step: Option<Step>,
    tolerance: f64,
    horizon: f64,
) -> PyResult<String> {
    let request = match (system, step) {
        (Some(text), _) => {
            let system = equations(&text)?;
            let start = system.q.iter().chain(&system.v).copied().collect();
            let dynamics = system.equations.dynamics().clone();
            ComparisonRequest { system: system.name, dynamics, start, horizon, tolerance }
        }
        (None, Some(step)) => {
            let problem = step.setting()?;
            let (system, dimension) = (problem.system, problem.q.len());
            let dynamics = dynamics_of(system, dimension).ok_or_else(|| {
                value_error(system.entry().wrong_dimension(dimension).to_string())
            })?;
            let start = problem.q.iter().chain(&problem.v).copied().collect();
            let system = system.name().to_owned();
            ComparisonRequest { system, dynamics, start, horizon, tolerance }
        }
        (None, None) => return Err(value_error("system is None".to_owned())),
    };
    let done =
        run_in_background(py, |stop| compare(&Work::new(&Silent, stop), &request), |_| Ok(()))?;
    Ok(json!(done.map_err(Raised::raised)?).to_string())
}
