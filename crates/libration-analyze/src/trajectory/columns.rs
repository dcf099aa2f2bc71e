//! Rows of a trajectory, kept as columns.

use std::borrow::Cow;
use std::collections::TryReserveError;

use libration::ensemble::InsufficientMemory;

use super::Request;
use crate::export::{Column, ExportError, Number, Rows, Table, Values};

/// Columns that grow row by row.
#[derive(Debug)]
pub(super) struct Columns<S> {
    /// The columns `step`, or `trajectory` and `step`.
    index: Vec<Vec<u64>>,
    t: Vec<f64>,
    values: Vec<Vec<S>>,
}

impl<S: Number> Columns<S> {
    /// Bytes of all rows of the request.
    pub(super) fn bytes(request: &Request) -> u128 {
        let whole = 2 + usize::from(request.ensemble.is_some());
        let numbers = 1 + 2 * request.q.len();
        let row = whole * size_of::<u64>() + numbers * size_of::<S>();
        u128::from(request.rows()) * row as u128
    }

    /// Empty columns with memory for all rows of the request.
    pub(super) fn new(request: &Request) -> Result<Self, InsufficientMemory> {
        let no_memory = || InsufficientMemory { needed: Self::bytes(request), available: None };
        let rows = usize::try_from(request.rows()).map_err(|_| no_memory())?;
        let columns = || {
            Ok(Columns {
                index: (0..1 + usize::from(request.ensemble.is_some()))
                    .map(|_| reserve(rows))
                    .collect::<Result<_, _>>()?,
                t: reserve(rows)?,
                values: (0..=2 * request.q.len())
                    .map(|_| reserve(rows))
                    .collect::<Result<_, _>>()?,
            })
        };
        columns().map_err(|_: TryReserveError| no_memory())
    }

    /// The columns with their names and units.
    pub(super) fn into_table(self, request: &Request) -> Result<Table<'static>, ExportError> {
        let index = self.index.into_iter().map(|column| Values::U64(Cow::Owned(column)));
        let first = index.chain([Values::F64(Cow::Owned(self.t))]);
        let values = first.chain(self.values.into_iter().map(S::values));
        let heads = request.column_names().into_iter().zip(request.column_units());
        let column = |((name, unit), values): ((String, &'static str), _)| Column {
            name: Cow::Owned(name),
            unit: Cow::Borrowed(unit),
            values,
        };
        Ok(Table::new(heads.zip(values).map(column).collect())?)
    }
}

fn reserve<T>(rows: usize) -> Result<Vec<T>, TryReserveError> {
    let mut column = Vec::new();
    column.try_reserve_exact(rows)?;
    Ok(column)
}

impl<S: Number> Rows<S> for Columns<S> {
    fn row(&mut self, index: &[u64], t: f64, values: &[S]) -> Result<(), ExportError> {
        for (column, &number) in self.index.iter_mut().zip(index) {
            column.push(number);
        }
        self.t.push(t);
        for (column, &value) in self.values.iter_mut().zip(values) {
            column.push(value);
        }
        Ok(())
    }
}
