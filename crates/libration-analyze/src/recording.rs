//! Simulations as tables and files.

use std::borrow::Cow;
use std::collections::TryReserveError;
use std::io::Write;

use libration::ensemble::InsufficientMemory;
use serde_json::Value;

use crate::export::{
    Column, Csv, ExportError, Json, Number, Rows, Table, Values, parquet_bytes, write_npy,
    write_parquet,
};
use crate::trajectory::{Format, Monitor, Outcome, TrajectoryError};

/// A checked request for a simulation in the float type `S`, whose rows become a table.
pub(crate) trait Recording<S: Number> {
    /// Names and units of the columns: `trajectory` if there are several, `step`, `t`, and the values.
    fn columns(&self) -> Vec<(String, String)>;

    /// Whether there are several trajectories.
    fn is_ensemble(&self) -> bool;

    /// Whole numbers before `t`.
    fn index_columns(&self) -> usize {
        1 + usize::from(self.is_ensemble())
    }

    /// Number of rows if all states stay finite.
    fn rows(&self) -> u64;

    /// The request as the first entries of a JSON file.
    fn head(&self) -> Vec<(&'static str, Value)>;

    /// Simulates, until the end or until `monitor` stops it.
    ///
    /// # Errors
    /// A [`TrajectoryError`].
    fn run(
        &self,
        rows: &mut dyn Rows<S>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError>;
}

/// Simulates and writes the rows into `out`. Rows of CSV and JSON are streamed.
pub(crate) fn write<S: Number>(
    recording: &dyn Recording<S>,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let several = recording.is_ensemble();
    let outcome = match format {
        Format::Csv => {
            let names: Vec<String> =
                recording.columns().into_iter().map(|(name, _)| quoted(name)).collect();
            let mut csv = Csv::new(&mut *out, names.iter().map(String::as_str))?;
            recording.run(&mut csv, monitor)?
        }
        Format::Json => {
            let mut json = Json::new(&mut *out, &recording.head())?;
            let outcome = recording.run(&mut json, monitor)?;
            json.finish(&outcome.json_entries(several))?;
            outcome
        }
        Format::Npy => {
            let (table, outcome) = table(recording, monitor, |_, _| 0)?;
            write_npy(&table, &mut *out).map_err(ExportError::from)?;
            outcome
        }
        Format::Parquet => {
            let encoding = |rows, bytes| parquet_bytes(rows, bytes, 1);
            let (table, outcome) = table(recording, monitor, encoding)?;
            let mut about: serde_json::Map<_, _> =
                recording.head().into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
            let entries = outcome.json_entries(several).into_iter();
            about.extend(entries.map(|(key, value)| (key.to_owned(), value)));
            let about = Value::Object(about).to_string();
            write_parquet(&table, &[("libration.trajectory", &about)], 1, &mut *out)
                .map_err(ExportError::from)?;
            outcome
        }
    };
    out.flush().map_err(ExportError::from)?;
    Ok(outcome)
}

/// Simulates and keeps all rows; `encoding` returns the bytes needed to write a table of some rows and bytes.
pub(crate) fn table<S: Number>(
    recording: &dyn Recording<S>,
    monitor: &dyn Monitor,
    encoding: fn(u64, u128) -> u128,
) -> Result<(Table<'static>, Outcome), TrajectoryError> {
    let heads = recording.columns();
    let mut columns = Columns::<S> {
        index: vec![vec![]; recording.index_columns()],
        t: Vec::new(),
        values: Vec::new(),
    };
    columns.values = vec![vec![]; heads.len() - columns.index.len() - 1];
    let row = (columns.index.len() + 1) * size_of::<u64>() + columns.values.len() * size_of::<S>();
    let bytes = u128::from(recording.rows()) * row as u128;
    let needed = bytes + encoding(recording.rows(), bytes);
    InsufficientMemory::check(needed).map_err(TrajectoryError::Memory)?;
    let no_memory =
        |_| TrajectoryError::Memory(InsufficientMemory { needed: bytes, available: None });
    columns.reserve(recording.rows()).map_err(no_memory)?;
    let outcome = recording.run(&mut columns, monitor)?;
    Ok((columns.into_table(heads)?, outcome))
}

/// A name as a field of a CSV file (RFC 4180).
fn quoted(name: String) -> String {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name,
    }
}

/// Rows that are kept as columns.
struct Columns<S> {
    /// `step`, or what a row belongs to and `step`.
    index: Vec<Vec<u64>>,
    t: Vec<f64>,
    values: Vec<Vec<S>>,
}

impl<S: Number> Columns<S> {
    fn reserve(&mut self, rows: u64) -> Result<(), TryReserveError> {
        let rows = usize::try_from(rows).unwrap_or(usize::MAX);
        self.index.iter_mut().try_for_each(|column| column.try_reserve_exact(rows))?;
        self.t.try_reserve_exact(rows)?;
        self.values.iter_mut().try_for_each(|column| column.try_reserve_exact(rows))
    }

    fn into_table(self, heads: Vec<(String, String)>) -> Result<Table<'static>, ExportError> {
        let index = self.index.into_iter().map(|column| Values::U64(Cow::Owned(column)));
        let first = index.chain([Values::F64(Cow::Owned(self.t))]);
        let values = first.chain(self.values.into_iter().map(S::values));
        let column = |((name, unit), values)| Column {
            name: Cow::Owned(name),
            unit: Cow::Owned(unit),
            values,
        };
        Ok(Table::new(heads.into_iter().zip(values).map(column).collect())?)
    }
}

impl<S: Number> Rows<S> for Columns<S> {
    fn row(&mut self, index: &[u64], t: f64, values: &[S]) -> Result<(), ExportError> {
        self.index.iter_mut().zip(index).for_each(|(column, &number)| column.push(number));
        self.t.push(t);
        self.values.iter_mut().zip(values).for_each(|(column, &value)| column.push(value));
        Ok(())
    }
}
