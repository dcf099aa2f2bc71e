//! The drift of the energy of an oscillator.

use libration::analysis::DriftForecast;
use serde::Serialize;
use serde_json::value::RawValue;

/// The largest relative energy drift over a number of steps, which follows from the step without simulation.
#[derive(Debug, Serialize)]
pub struct Drift {
    /// `max |E_n − E₀| / |E₀|`, as a decimal that may exceed the range of an `f64`.
    pub max_energy_drift: Box<RawValue>,
    /// Its decimal logarithm; none if there is no drift at all.
    pub log10_max_energy_drift: Option<f64>,
    /// The step with this drift.
    pub max_energy_drift_step: u64,
}

impl From<DriftForecast> for Drift {
    fn from(forecast: DriftForecast) -> Self {
        let value = forecast.drift.to_f64();
        let decimal =
            if value.is_infinite() { forecast.drift.to_decimal(17) } else { format!("{value:?}") };
        Drift {
            max_energy_drift: raw(decimal),
            log10_max_energy_drift: (!forecast.drift.is_zero())
                .then(|| forecast.drift.log10().to_f64()),
            max_energy_drift_step: forecast.at_step,
        }
    }
}

/// A JSON number from its digits.
fn raw(decimal: String) -> Box<RawValue> {
    RawValue::from_string(decimal).unwrap_or_else(|_| RawValue::NULL.to_owned())
}
