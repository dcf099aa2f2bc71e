//! Trajectories of linear plants and of loops around them as tables, the output of `libration simulate --plant`.
//!
//! A row belongs to the beginning of a period. Its columns are `step`, `t`, the states, the measurements that the controller reads, the
//! inputs that act, and the cost so far, with `trajectory` before them where there are several.

mod request;
mod run;

use std::borrow::Cow;
use std::io::Write;

use libration::ensemble::InsufficientMemory;
use serde_json::{Value, json};

use crate::export::{
    Column, Csv, ExportError, Json, Rows, Table, Values, parquet_bytes, write_npy, write_parquet,
};
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
    let several = request.ensemble.is_some();
    let outcome = match format {
        Format::Csv => {
            let names: Vec<String> =
                request.columns().into_iter().map(|(name, _)| quoted(name)).collect();
            let mut csv = Csv::new(&mut *out, names.iter().map(String::as_str))?;
            run::run(request, &mut csv, monitor)?
        }
        Format::Json => {
            let mut json = Json::new(&mut *out, &head(request))?;
            let outcome = run::run(request, &mut json, monitor)?;
            let (key, value) = outcome.json_entry(several);
            json.finish(key, &value)?;
            outcome
        }
        Format::Npy => {
            let (table, outcome) = table(request, monitor, |_, _| 0)?;
            write_npy(&table, &mut *out).map_err(ExportError::from)?;
            outcome
        }
        Format::Parquet => {
            let encoding = |rows, bytes| parquet_bytes(rows, bytes, 1);
            let (table, outcome) = table(request, monitor, encoding)?;
            let mut about: serde_json::Map<_, _> =
                head(request).into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
            let (key, value) = outcome.json_entry(several);
            about.insert(key.to_owned(), value);
            let about = Value::Object(about).to_string();
            write_parquet(&table, &[("libration.trajectory", &about)], 1, &mut *out)
                .map_err(ExportError::from)?;
            outcome
        }
    };
    out.flush().map_err(ExportError::from)?;
    Ok(outcome)
}

/// A name as a field of a CSV file (RFC 4180).
fn quoted(name: String) -> String {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name,
    }
}

/// Rows that are kept as columns.
struct Columns {
    index: Vec<Vec<u64>>,
    numbers: Vec<Vec<f64>>,
}

impl Rows<f64> for Columns {
    fn row(&mut self, index: &[u64], t: f64, values: &[f64]) -> Result<(), ExportError> {
        self.index.iter_mut().zip(index).for_each(|(column, &x)| column.push(x));
        let numbers = [t].into_iter().chain(values.iter().copied());
        self.numbers.iter_mut().zip(numbers).for_each(|(column, x)| column.push(x));
        Ok(())
    }
}

/// Simulates and keeps all rows; `encoding` returns the bytes needed to write a table of some rows and bytes.
fn table(
    request: &LinearRequest,
    monitor: &dyn Monitor,
    encoding: fn(u64, u128) -> u128,
) -> Result<(Table<'static>, Outcome), TrajectoryError> {
    let heads = request.columns();
    let whole = 1 + usize::from(request.ensemble.is_some());
    let rows = request.rows();
    let bytes = u128::from(rows) * (heads.len() * size_of::<f64>()) as u128;
    InsufficientMemory::check(bytes + encoding(rows, bytes)).map_err(TrajectoryError::Memory)?;
    let numbers = heads.len() - whole;
    let mut columns = Columns { index: vec![vec![]; whole], numbers: vec![vec![]; numbers] };
    let outcome = run::run(request, &mut columns, monitor)?;
    let index = columns.index.into_iter().map(|column| Values::U64(Cow::Owned(column)));
    let numbers = columns.numbers.into_iter().map(|column| Values::F64(Cow::Owned(column)));
    let column =
        |((name, unit), values)| Column { name: Cow::Owned(name), unit: Cow::Owned(unit), values };
    let columns = heads.into_iter().zip(index.chain(numbers)).map(column).collect();
    Ok((Table::new(columns).map_err(ExportError::from)?, outcome))
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
