//! Trajectories as a table: what `libration simulate` writes.
//!
//! The columns are `step`, `t`, `q0` …, `v0` … and `energy`, with `trajectory` before them where there
//! are several. A state that overflows ends the table of one trajectory; of several, the others go
//! on. It is a result and not an error.

mod columns;
mod copies;
mod error;
mod float_type;
mod format;
mod loops;
mod many;
mod overflow;
mod request;
mod run;
mod watch;

use std::io::Write;
use std::sync::atomic::AtomicBool;

use columns::Columns;
use libration::Float;
use libration::control::{Feedback, Jitter, Latency};
use libration::ensemble::InsufficientMemory;
use libration_settings::units;
use many::Many;
use serde::Serialize;
use serde_json::{Value, json};

use crate::analyze::Timing;
use crate::export::{Csv, ExportError, Json, Table, parquet_bytes, write_npy, write_parquet};

pub use copies::Copies;
pub use error::TrajectoryError;
pub use float_type::FloatType;
pub use format::Format;
pub use request::Request;
pub use watch::Watch;

/// Version of the contract that the JSON form keeps.
pub const SCHEMA: &str = "libration.trajectory/1";

/// A trajectory in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// The rows: the start, each step that was asked for, and the last.
    pub table: Table<'static>,
    /// Whether all states were finite.
    pub ending: Ending,
}

/// Whether all states were finite, to the end.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// They were.
    Whole,
    /// The only trajectory ends early.
    Stopped(Stopped),
    /// Some of several trajectories are not finite in the end; they have disturbed no other.
    NotFinite {
        /// How many.
        count: usize,
        /// The first ten of them.
        first: Vec<usize>,
        /// Why, and what to do, where that is known.
        reason: Option<String>,
    },
}

impl Ending {
    /// That of the trajectories of `request`, of which these are not finite.
    fn of<S: Float>(request: &Request, lost: &[usize]) -> Self {
        match lost.len() {
            0 => Ending::Whole,
            count => Ending::NotFinite {
                count,
                first: lost.iter().copied().take(10).collect(),
                reason: overflow::cause::<S>(request),
            },
        }
    }

    /// What a file says of it: the key, and its value.
    fn told(&self, several: bool) -> (&'static str, Value) {
        match self {
            Ending::Stopped(stopped) => ("stopped", json!(stopped)),
            Ending::NotFinite { count, first, reason } => {
                let mut told = json!({ "count": count, "first": first });
                if let Some(reason) = reason {
                    told["reason"] = json!(reason);
                }
                ("not_finite", told)
            }
            Ending::Whole if several => ("not_finite", json!({ "count": 0, "first": [] })),
            Ending::Whole => ("stopped", Value::Null),
        }
    }
}

/// The end of a trajectory whose state stopped being finite.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stopped {
    /// The first step whose result is not finite. The last row is that of the step before.
    pub step: u64,
    /// Its time in seconds.
    pub t: f64,
    /// What happened, and why and what to do where that is known.
    pub reason: String,
}

/// Simulates what is asked and keeps all rows.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request itself is wrong.
pub fn simulate(request: &Request) -> Result<Trajectory, TrajectoryError> {
    simulate_until(request, &AtomicBool::new(false))
}

/// The same, until `watch` says to stop.
///
/// # Errors
/// As [`simulate`], and [`TrajectoryError::Interrupted`].
pub fn simulate_until(request: &Request, watch: &dyn Watch) -> Result<Trajectory, TrajectoryError> {
    match request.float {
        FloatType::F64 => keep::<f64>(request, watch, |_, _| 0),
        FloatType::F32 => keep::<f32>(request, watch, |_, _| 0),
        FloatType::F16 => keep::<half::f16>(request, watch, |_, _| 0),
        FloatType::Bf16 => keep::<half::bf16>(request, watch, |_, _| 0),
    }
}

/// Simulates the request and writes its rows into `out`, until the end or until `watch` says to stop.
///
/// CSV and JSON rows are written as they come, so that a trajectory of any length takes no memory
/// and a reader that goes away ends the work. (`out` is dynamic so that the loops, some hundreds of
/// them, are compiled in this crate, once.)
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request itself is wrong.
pub fn write(
    request: &Request,
    format: Format,
    out: &mut (dyn Write + Send),
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    match request.float {
        FloatType::F64 => write_as::<f64>(request, format, out, watch),
        FloatType::F32 => write_as::<f32>(request, format, out, watch),
        FloatType::F16 => write_as::<half::f16>(request, format, out, watch),
        FloatType::Bf16 => write_as::<half::bf16>(request, format, out, watch),
    }
}

/// Keeps all rows; `encoding` gives the bytes that it takes to write a table of so many rows and bytes.
fn keep<S: Many>(
    request: &Request,
    watch: &dyn Watch,
    encoding: fn(u64, u128) -> u128,
) -> Result<Trajectory, TrajectoryError> {
    admit::<S>(request)?;
    let bytes = Columns::<S>::bytes(request);
    let needed = bytes + encoding(request.rows(), bytes);
    InsufficientMemory::check(needed).map_err(TrajectoryError::Memory)?;
    let mut columns = Columns::<S>::new(request).map_err(TrajectoryError::Memory)?;
    let ending = run::run(request, &mut columns, watch)?;
    Ok(Trajectory { table: columns.into_table(request)?, ending })
}

/// Checks all that can be checked before the first row.
fn admit<S: Many>(request: &Request) -> Result<(), TrajectoryError> {
    request.check::<S>()?;
    let one = Copies { count: 1, spread: 0.0, threads: 1, instructions: None };
    let looped = request.looped().map(|_| one);
    request.copies.or(looped).map_or(Ok(()), |copies| S::admits(request, &copies))
}

fn write_as<S: Many>(
    request: &Request,
    format: Format,
    out: &mut (dyn Write + Send),
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    admit::<S>(request)?;
    let several = request.copies.is_some();
    let ending = match format {
        Format::Csv => {
            let names = request.column_names();
            let mut csv = Csv::new(&mut *out, names.iter().map(String::as_str))?;
            run::run::<S>(request, &mut csv, watch)?
        }
        Format::Json => {
            let mut json = Json::new(&mut *out, &head(request))?;
            let ending = run::run::<S>(request, &mut json, watch)?;
            let (key, value) = ending.told(several);
            json.finish(key, &value)?;
            ending
        }
        Format::Npy => {
            let Trajectory { table, ending } = keep::<S>(request, watch, |_, _| 0)?;
            write_npy(&table, &mut *out).map_err(ExportError::from)?;
            ending
        }
        Format::Parquet => {
            let Trajectory { table, ending } =
                keep::<S>(request, watch, |rows, bytes| parquet_bytes(rows, bytes, 1))?;
            let mut about: serde_json::Map<_, _> =
                head(request).into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
            let (key, value) = ending.told(several);
            about.insert(key.to_owned(), value);
            let about = Value::Object(about).to_string();
            write_parquet(&table, &[("libration.trajectory", &about)], 1, &mut *out)
                .map_err(ExportError::from)?;
            ending
        }
    };
    out.flush().map_err(ExportError::from)?;
    Ok(ending)
}

/// A law as it is asked for.
fn law_named(law: Jitter) -> String {
    match law {
        Jitter::Gaussian(rms) => format!("gaussian:{rms:?}"),
        Jitter::Uniform(rms) => format!("uniform:{rms:?}"),
    }
}

/// What was asked, as it stands at the head of a JSON file.
fn head(request: &Request) -> Vec<(&'static str, Value)> {
    let parameters: serde_json::Map<_, _> =
        request.parameters().into_iter().map(|(k, v)| (k.to_owned(), v.into())).collect();
    let mut head: Vec<(&'static str, Value)> = vec![
        ("schema", SCHEMA.into()),
        ("system", request.system.name().into()),
        ("parameters", parameters.into()),
        ("integrator", request.stepping.name().into()),
        ("float", request.float.name().into()),
        ("dt", request.dt.into()),
        ("steps", request.steps.into()),
        ("every", request.every.into()),
        ("columns", request.column_names().into()),
        ("units", request.column_units().into()),
    ];
    let Timing { feedback, jitter, skew, .. } = request.timing;
    if request.looped().is_some() {
        head.push(("seed", request.seed.into()));
    }
    if let Some(record) = &request.record {
        head.push(("recorded_steps", record.len().into()));
    }
    if let Some(Feedback { position, velocity }) = feedback {
        let late = request.timing.latency_of(request.dt).map_or(f64::NAN, Latency::steps);
        head.push(("feedback", json!([position, velocity])));
        let units = units::of(request.system, request.actuation);
        head.push(("feedback_units", json!(units.gains[..2])));
        head.push(("command", request.actuation.name().into()));
        head.push(("latency_steps", late.into()));
    }
    for (name, law) in [("jitter", jitter), ("skew", skew)] {
        if let Some(law) = law {
            head.push((name, law_named(law).into()));
        }
    }
    if let Some(copies) = request.copies {
        head.push(("count", copies.count.into()));
        head.push(("spread", copies.spread.into()));
    }
    head
}
