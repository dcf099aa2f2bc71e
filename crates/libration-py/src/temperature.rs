//! Temperatures of thermostats.

use libration::thermostat::LangevinMethod;
use libration_analyze::temperature::{TemperatureError, TemperatureRequest, analyze_temperature};
use libration_work::{Silent, Work};
use pyo3::prelude::*;
use serde_json::json;

use crate::background::run_in_background;
use crate::equations::{AnySystem, any_system};
use crate::error::{Raised, interrupted, value_error};

impl Raised for TemperatureError {
    fn raised(self) -> PyErr {
        match self {
            TemperatureError::Interrupted => interrupted(),
            error => value_error(error.to_string()),
        }
    }
}

/// Predicts and measures temperatures of a system by equations or of the catalogue. Gives JSON.
#[pyfunction]
pub(crate) fn _analyze_temperature(
    py: Python<'_>,
    system: AnySystem,
    numbers: (f64, f64, Option<f64>),
    thermostats: Option<Vec<String>>,
    draws: (u64, u64),
) -> PyResult<String> {
    let ((temperature, friction, dt), (steps, seed)) = (numbers, draws);
    let system = any_system(&system)?;
    let thermostats = match thermostats {
        None => LangevinMethod::common(),
        Some(names) => names
            .iter()
            .map(|name| name.parse::<LangevinMethod>())
            .collect::<Result<_, _>>()
            .map_err(|error| value_error(error.to_string()))?,
    };
    let request =
        TemperatureRequest { system, temperature, friction, dt, thermostats, steps, seed };
    let done = run_in_background(
        py,
        |stop| analyze_temperature(&Work::new(&Silent, stop), &request),
        |_| Ok(()),
    )?;
    Ok(json!(done.map_err(Raised::raised)?).to_string())
}
