//! One trajectory as a table: what `libration simulate` writes.
//!
//! The columns are `step`, `t`, `q0` …, `v0` … and `energy`. A state that overflows ends the
//! table; it is a result and not an error.

mod columns;
mod error;
mod float_type;
mod format;
mod request;
mod run;
mod units;

use std::io::Write;
use std::sync::atomic::AtomicBool;

use serde::Serialize;
use serde_json::{Value, json};

use crate::export::{Csv, Json, Number, Table, write_npy, write_parquet};
use columns::Columns;

pub use error::TrajectoryError;
pub use float_type::FloatType;
pub use format::Format;
pub use request::Request;

/// Version of the contract that the JSON form keeps.
pub const SCHEMA: &str = "libration.trajectory/1";

/// A trajectory in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// The rows: the start, each step that was asked for, and the last.
    pub table: Table<'static>,
    /// Why there are fewer steps than were asked for, if there are.
    pub stopped: Option<Stopped>,
}

/// The end of a trajectory whose state stopped being finite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stopped {
    /// The first step whose result is not finite. The last row is that of the step before.
    pub step: u64,
    /// Its time in seconds.
    pub t: f64,
    /// What happened.
    pub reason: &'static str,
}

/// Simulates what is asked and keeps all rows.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request itself is wrong.
pub fn simulate(request: &Request) -> Result<Trajectory, TrajectoryError> {
    let stop = AtomicBool::new(false);
    match request.float {
        FloatType::F64 => keep::<f64>(request, &stop),
        FloatType::F32 => keep::<f32>(request, &stop),
        FloatType::F16 => keep::<half::f16>(request, &stop),
        FloatType::Bf16 => keep::<half::bf16>(request, &stop),
    }
}

/// Simulates what is asked and writes it into `out`, until the end or until `stop` is set.
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
    stop: &AtomicBool,
) -> Result<Option<Stopped>, TrajectoryError> {
    match request.float {
        FloatType::F64 => write_as::<f64>(request, format, out, stop),
        FloatType::F32 => write_as::<f32>(request, format, out, stop),
        FloatType::F16 => write_as::<half::f16>(request, format, out, stop),
        FloatType::Bf16 => write_as::<half::bf16>(request, format, out, stop),
    }
}

fn keep<S: Number>(request: &Request, stop: &AtomicBool) -> Result<Trajectory, TrajectoryError> {
    request.check::<S>()?;
    let mut columns = Columns::<S>::new(request)?;
    let stopped = run::run(request, &mut columns, stop)?;
    Ok(Trajectory { table: columns.into_table(request)?, stopped })
}

fn write_as<S: Number>(
    request: &Request,
    format: Format,
    out: &mut (dyn Write + Send),
    stop: &AtomicBool,
) -> Result<Option<Stopped>, TrajectoryError> {
    request.check::<S>()?;
    let stopped = match format {
        Format::Csv => {
            let names = request.column_names();
            let mut csv = Csv::new(&mut *out, names.iter().map(String::as_str))?;
            run::run::<S>(request, &mut csv, stop)?
        }
        Format::Json => {
            let mut json = Json::new(&mut *out, &head(request))?;
            let stopped = run::run::<S>(request, &mut json, stop)?;
            json.finish("stopped", &stopped)?;
            stopped
        }
        Format::Npy => {
            let Trajectory { table, stopped } = keep::<S>(request, stop)?;
            write_npy(&table, &mut *out)?;
            stopped
        }
        Format::Parquet => {
            let Trajectory { table, stopped } = keep::<S>(request, stop)?;
            let mut about: serde_json::Map<_, _> =
                head(request).into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
            about.insert("stopped".to_owned(), json!(stopped));
            let about = Value::Object(about).to_string();
            write_parquet(&table, &[("libration.trajectory", &about)], &mut *out)?;
            stopped
        }
    };
    out.flush().map_err(crate::export::ExportError::from)?;
    Ok(stopped)
}

/// What was asked, as it stands at the head of a JSON file.
fn head(request: &Request) -> Vec<(&'static str, Value)> {
    let parameters: serde_json::Map<_, _> =
        request.system.parameters().into_iter().map(|(k, v)| (k.to_owned(), v.into())).collect();
    vec![
        ("schema", SCHEMA.into()),
        ("system", request.system.name().into()),
        ("parameters", parameters.into()),
        ("integrator", request.method.name().into()),
        ("float", request.float.name().into()),
        ("dt", request.dt.into()),
        ("steps", request.steps.into()),
        ("every", request.every.into()),
        ("columns", request.column_names().into()),
        ("units", request.column_units().into()),
    ]
}
