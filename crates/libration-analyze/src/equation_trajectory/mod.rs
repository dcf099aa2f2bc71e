//! Trajectories of systems by equations as tables, the output of `libration simulate --system FILE`.
//!
//! The columns are `step`, `t`, the coordinates by their names, their velocities with a prime, the states of first order, and the energy
//! where the system has one.

mod request;
mod run;

use std::io::Write;

use half::{bf16, f16};
use serde_json::{Value, json};

use crate::export::Rows;
use crate::recording::{self, Recording};
use crate::trajectory::{
    EnsembleFloat, FloatType, Format, Monitor, Outcome, Trajectory, TrajectoryError,
};

pub use request::EquationRequest;

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.equation-trajectory/1";

/// Simulates the request, until the end or until `monitor` stops it, and keeps all rows.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request is invalid.
pub fn simulate_until(
    request: &EquationRequest,
    monitor: &dyn Monitor,
) -> Result<Trajectory, TrajectoryError> {
    match request.float {
        FloatType::F64 => simulate_as::<f64>(request, monitor),
        FloatType::F32 => simulate_as::<f32>(request, monitor),
        FloatType::F16 => simulate_as::<f16>(request, monitor),
        FloatType::Bf16 => simulate_as::<bf16>(request, monitor),
    }
}

fn simulate_as<S: EnsembleFloat>(
    request: &EquationRequest,
    monitor: &dyn Monitor,
) -> Result<Trajectory, TrajectoryError> {
    request.check::<S>()?;
    let (table, outcome) = recording::table::<S>(request, monitor, |_, _| 0)?;
    Ok(Trajectory { table, outcome })
}

/// Simulates the request and writes its rows into `out`, until the end or until `monitor` stops it.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request is invalid.
pub fn write(
    request: &EquationRequest,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    match request.float {
        FloatType::F64 => write_as::<f64>(request, format, out, monitor),
        FloatType::F32 => write_as::<f32>(request, format, out, monitor),
        FloatType::F16 => write_as::<f16>(request, format, out, monitor),
        FloatType::Bf16 => write_as::<bf16>(request, format, out, monitor),
    }
}

fn write_as<S: EnsembleFloat>(
    request: &EquationRequest,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    request.check::<S>()?;
    recording::write::<S>(request, format, out, monitor)
}

impl<S: EnsembleFloat> Recording<S> for EquationRequest {
    fn columns(&self) -> Vec<(String, String)> {
        EquationRequest::columns(self)
    }

    fn is_ensemble(&self) -> bool {
        self.ensemble.is_some()
    }

    fn rows(&self) -> u64 {
        EquationRequest::rows(self)
    }

    fn head(&self) -> Vec<(&'static str, Value)> {
        let (names, units): (Vec<String>, Vec<String>) =
            EquationRequest::columns(self).into_iter().unzip();
        let parameters: serde_json::Map<String, Value> = self
            .system
            .definitions
            .parameters
            .iter()
            .map(|(k, v)| (k.clone(), (*v).into()))
            .collect();
        let mut head = vec![
            ("schema", SCHEMA.into()),
            ("system", self.system.name.clone().into()),
            ("parameters", parameters.into()),
            ("integrator", self.method.name().into()),
            ("float", self.float.name().into()),
            ("dt", self.dt.into()),
            ("steps", self.steps.into()),
            ("every", self.every.into()),
            ("columns", json!(names)),
            ("units", json!(units)),
        ];
        if let Some(ensemble) = &self.ensemble {
            head.extend([("count", ensemble.count.into()), ("spread", ensemble.spread.into())]);
        }
        head
    }

    fn run(
        &self,
        rows: &mut dyn Rows<S>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError> {
        match &self.ensemble {
            Some(ensemble) => run::run_ensemble(self, ensemble, rows, monitor),
            None => run::run(self, rows, monitor),
        }
    }
}
