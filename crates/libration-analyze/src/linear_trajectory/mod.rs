//! Trajectories of linear plants and of loops around them as tables, the output of `libration simulate --plant`.
//!
//! A row belongs to the beginning of a period. Its columns are `step`, `t`, the states, the measurements that the controller reads, the
//! inputs that act, and the cost so far, with `trajectory` before them where there are several.

mod request;
mod run;
mod system_motion;

use std::io::Write;

use serde_json::{Value, json};

use crate::export::Rows;
use crate::recording::{self, Recording};
use crate::trajectory::{Format, Monitor, Outcome, TrajectoryError};

pub use request::LinearRequest;

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.linear-trajectory/1";

/// Simulates the request and writes its rows into `out`, until the end or until `monitor` stops it.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request is invalid.
pub fn write(
    request: &LinearRequest,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    request.check()?;
    recording::write::<f64>(request, format, out, monitor)
}

impl Recording<f64> for LinearRequest {
    fn columns(&self) -> Vec<(String, String)> {
        LinearRequest::columns(self)
    }

    fn is_ensemble(&self) -> bool {
        self.ensemble.is_some()
    }

    fn rows(&self) -> u64 {
        LinearRequest::rows(self)
    }

    fn head(&self) -> Vec<(&'static str, Value)> {
        head(self)
    }

    fn run(
        &self,
        rows: &mut dyn Rows<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError> {
        run::run(self, rows, monitor)
    }
}

/// The request as the first entries of a JSON file.
fn head(request: &LinearRequest) -> Vec<(&'static str, Value)> {
    let LinearRequest { linear, timing, .. } = request;
    let (names, units): (Vec<String>, Vec<String>) = request.columns().into_iter().unzip();
    let periods = |latencies: &[libration::control::Latency]| {
        latencies.iter().map(|latency| latency.steps()).collect::<Vec<f64>>()
    };
    let mut head: Vec<(&'static str, Value)> = vec![
        ("schema", SCHEMA.into()),
        ("period", linear.period().into()),
        ("steps", request.steps.into()),
        ("every", request.every.into()),
        ("seed", request.seed.into()),
        ("latency_periods", json!(periods(&timing.input_latency))),
        ("output_latency_periods", json!(periods(&timing.output_latency))),
        ("jitter", crate::trajectory::jitter_text(timing.jitter).into()),
        ("recorded_steps", json!(request.record.as_ref().map(Vec::len))),
        ("skew", timing.skew.into()),
        ("loss", timing.loss.into()),
        ("reference", json!(request.reference)),
        ("disturbance", json!(request.disturbance)),
        ("columns", names.into()),
        ("units", units.into()),
    ];
    if let Some(ensemble) = request.ensemble {
        head.push(("count", ensemble.count.into()));
        head.push(("spread", ensemble.spread.into()));
    }
    head
}
