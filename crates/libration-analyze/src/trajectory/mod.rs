//! Trajectories as tables, the output of `libration simulate`.
//!
//! The columns are `step`, `t`, the coordinates by their names, their velocities with a prime, the states of first order, and the
//! energy where the system has one, with `trajectory` before them where there are several. An overflow ends the table of a single trajectory; in an ensemble the others continue.
//! It is a result and not an error.

mod ensemble;
mod ensemble_options;
mod error;
mod exact_step;
mod float_type;
mod format;
mod loops;
mod monitor;
mod outcome;
mod overflow;
mod request;
mod run;
mod three_digits;

use std::io::Write;
use std::sync::atomic::AtomicBool;

use libration::control::{Feedback, Jitter, Latency};
use libration_settings::equations::Twin;
use libration_settings::units;
use serde_json::{Value, json};

use crate::Timing;
use crate::export::{Rows, Table};
use crate::recording::{self, Recording};

pub(crate) use ensemble::EnsembleFloat;
pub use ensemble_options::EnsembleOptions;
pub(crate) use ensemble_options::rows;
pub use error::TrajectoryError;
pub use float_type::FloatType;
pub use format::Format;
pub use monitor::Monitor;
pub use outcome::{Divergence, Outcome};
pub use request::Request;
pub(crate) use request::{time_columns, value_columns};

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.trajectory/1";

/// A trajectory in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// The rows: the start, each `every`-th step, and the last step.
    pub table: Table<'static>,
    /// How the trajectory ended.
    pub outcome: Outcome,
}

/// Simulates the request and keeps all rows.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request is invalid.
pub fn simulate(request: &Request) -> Result<Trajectory, TrajectoryError> {
    simulate_until(request, &AtomicBool::new(false))
}

/// As [`simulate`], until `monitor` stops it.
///
/// # Errors
/// As [`simulate`], and [`TrajectoryError::Interrupted`].
pub fn simulate_until(
    request: &Request,
    monitor: &dyn Monitor,
) -> Result<Trajectory, TrajectoryError> {
    match request.float {
        FloatType::F64 => simulate_table::<f64>(request, monitor),
        FloatType::F32 => simulate_table::<f32>(request, monitor),
        FloatType::F16 => simulate_table::<half::f16>(request, monitor),
        FloatType::Bf16 => simulate_table::<half::bf16>(request, monitor),
    }
}

/// Simulates the request and writes its rows into `out`, until the end or until `monitor` stops it.
///
/// CSV and JSON rows are streamed: a trajectory of any length needs no memory, and a closed pipe ends the
/// work. `out` is dynamic so that the loops are compiled once, in this crate.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request is invalid.
pub fn write(
    request: &Request,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    match request.float {
        FloatType::F64 => write_as::<f64>(request, format, out, monitor),
        FloatType::F32 => write_as::<f32>(request, format, out, monitor),
        FloatType::F16 => write_as::<half::f16>(request, format, out, monitor),
        FloatType::Bf16 => write_as::<half::bf16>(request, format, out, monitor),
    }
}

fn simulate_table<S: EnsembleFloat>(
    request: &Request,
    monitor: &dyn Monitor,
) -> Result<Trajectory, TrajectoryError> {
    check_request::<S>(request)?;
    let (table, outcome) = recording::table::<S>(request, monitor, |_, _| 0)?;
    Ok(Trajectory { table, outcome })
}

/// Checks the request and its memory before the first row.
fn check_request<S: EnsembleFloat>(request: &Request) -> Result<(), TrajectoryError> {
    request.check::<S>()?;
    let one = EnsembleOptions { count: 1, spread: 0.0, threads: 1, instructions: None };
    let looped = request.loop_option().map(|_| one);
    request.ensemble.or(looped).map_or(Ok(()), |ensemble| S::check_memory(request, &ensemble))
}

fn write_as<S: EnsembleFloat>(
    request: &Request,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    check_request::<S>(request)?;
    recording::write::<S>(request, format, out, monitor)
}

impl<S: EnsembleFloat> Recording<S> for Request {
    fn columns(&self) -> Vec<(String, String)> {
        Request::columns(self)
    }

    fn is_ensemble(&self) -> bool {
        self.ensemble.is_some()
    }

    fn rows(&self) -> u64 {
        Request::rows(self)
    }

    fn head(&self) -> Vec<(&'static str, Value)> {
        head(self)
    }

    fn run(
        &self,
        rows: &mut dyn Rows<S>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError> {
        run::run::<S>(self, rows, monitor)
    }
}

/// The text of a law, as in `gaussian:0.1`.
pub(crate) fn jitter_text(law: Jitter) -> String {
    match law {
        Jitter::Gaussian(rms) => format!("gaussian:{rms:?}"),
        Jitter::Uniform(rms) => format!("uniform:{rms:?}"),
    }
}

/// The request as the first entries of a JSON file.
fn head(request: &Request) -> Vec<(&'static str, Value)> {
    let system = &request.system;
    let parameters = system.definitions.parameters.iter();
    let parameters: serde_json::Map<_, _> =
        parameters.map(|(name, x)| (name.clone(), (*x).into())).collect();
    let (names, units): (Vec<String>, Vec<String>) = request.columns().into_iter().unzip();
    let mut head: Vec<(&'static str, Value)> = vec![
        ("schema", SCHEMA.into()),
        ("system", system.name.clone().into()),
        ("parameters", parameters.into()),
        ("integrator", request.stepping.name().into()),
        ("dtype", request.float.name().into()),
        ("dt", request.dt.into()),
        ("steps", request.steps.into()),
        ("every", request.every.into()),
        ("columns", names.into()),
        ("units", units.into()),
    ];
    let Timing { feedback, jitter, skew, .. } = request.timing;
    if request.loop_option().is_some() {
        head.push(("seed", request.seed.into()));
    }
    if let Some(record) = &request.record {
        head.push(("recorded_steps", record.len().into()));
    }
    if let (Some(Feedback { position, velocity }), Some(Twin { system, actuation })) =
        (feedback, system.twin)
    {
        let late = request.timing.latency_of(request.dt).map_or(f64::NAN, Latency::steps);
        head.push(("feedback", json!([position, velocity])));
        let units = units::of(system, actuation);
        head.push(("feedback_units", json!(units.gains[..2])));
        head.push(("command", actuation.name().into()));
        head.push(("latency_steps", late.into()));
    }
    for (name, law) in [("jitter", jitter), ("skew", skew)] {
        if let Some(law) = law {
            head.push((name, jitter_text(law).into()));
        }
    }
    if let Some(ensemble) = request.ensemble {
        head.push(("count", ensemble.count.into()));
        head.push(("spread", ensemble.spread.into()));
    }
    head
}
