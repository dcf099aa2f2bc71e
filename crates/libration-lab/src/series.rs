//! Series of a record as Parquet files.

use std::borrow::Cow;

use libration_data::{Column, Table, TableError, Values, write_parquet};
use libration_report::record::Series;

/// The series as a Parquet file. NaN stays NaN.
///
/// # Errors
/// [`TableError::Ragged`] if its columns differ in length.
pub fn series_to_parquet(series: &Series) -> Result<Vec<u8>, TableError> {
    let column = |c: &libration_report::record::Column| Column {
        name: Cow::Owned(c.name.clone()),
        unit: Cow::Owned(c.unit.clone()),
        values: Values::F64(Cow::Owned(c.values.clone())),
    };
    let table = Table::new(series.columns.iter().map(column).collect())?;
    let mut bytes = Vec::new();
    write_parquet(&table, &[("libration.series", &series.name)], 1, &mut bytes)?;
    Ok(bytes)
}
