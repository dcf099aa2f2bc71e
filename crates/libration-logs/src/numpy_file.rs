//! Files of NumPy: arrays in `.npz`, or one in `.npy`.

use libration_data::{ArrayValues, NamedArray, parse_npy, parse_npy_records, read_npz};

use crate::column::{Column, Values};
use crate::error::LogError;
use crate::input::Input;
use crate::read_options::ReadOptions;
use crate::table::Table;
use crate::unpack_budget::most_unpacked;

/// Largest file, and largest sum of the arrays in it.
const LIMIT: usize = 1 << 31;
/// Most columns of an array.
const MOST_COLUMNS: usize = 4096;

/// Reads the arrays with as many rows as the column of time.
pub(crate) fn open(input: &Input, options: &ReadOptions) -> Result<Table, LogError> {
    table(&input.bytes(LIMIT as u64)?, options)
}

fn table(bytes: &[u8], options: &ReadOptions) -> Result<Table, LogError> {
    let most = usize::try_from(most_unpacked(bytes.len() as u64)).unwrap_or(LIMIT).min(LIMIT);
    let (format, arrays) = match bytes.starts_with(b"PK") {
        true => ("NumPy archive", read_npz(bytes, most).map_err(LogError::Damaged)?),
        false => {
            let records = parse_npy_records(bytes).map_err(LogError::Damaged)?;
            let alone = || {
                let values = parse_npy(bytes).map_err(LogError::Damaged)?;
                Ok(vec![NamedArray { name: "column".to_owned(), values }])
            };
            ("NumPy array", records.map_or_else(alone, Ok::<_, LogError>)?)
        }
    };
    let columns: Vec<Column> = arrays.into_iter().flat_map(columns).collect();
    let is_wanted = |column: &&Column| match &options.time {
        Some(name) => column.name == *name,
        None => crate::time_unit::is_time_name(&column.name),
    };
    // Without a column of time, the longest arrays are the signals.
    let time_rows = columns.iter().find(is_wanted).map(Column::rows);
    let rows = time_rows.or_else(|| columns.iter().map(Column::rows).max()).unwrap_or(0);
    let (columns, others): (Vec<_>, Vec<_>) =
        columns.into_iter().partition(|column| column.rows() == rows);
    let name = |column: &Column| {
        format!("`{}` has {} rows, not {rows}: ignored", column.name, column.rows())
    };
    let ignored = others.iter().map(name).collect();
    Ok(Table::new(format, columns, options, Vec::new())?.with_ignored(ignored))
}

/// The columns of an array: those of a matrix are `name[0]`, `name[1]`, of a lone array `column_1`, `column_2`.
fn columns(array: NamedArray) -> Vec<Column> {
    let is_lone = array.name == "column";
    let names = |count: usize| -> Vec<String> {
        match (is_lone, count) {
            (true, _) => (1..=count).map(|i| format!("column_{i}")).collect(),
            (false, 1) => vec![array.name.clone()],
            (false, _) => (0..count).map(|i| format!("{}[{i}]", array.name)).collect(),
        }
    };
    match &array.values {
        ArrayValues::Text(_) => Vec::new(),
        ArrayValues::Numbers { shape, entries } => split(shape, entries, &names, Values::Floats),
        ArrayValues::Integers { shape, entries } => split(shape, entries, &names, Values::Whole),
    }
}

fn split<T: Copy>(
    shape: &[usize],
    entries: &[T],
    names: &dyn Fn(usize) -> Vec<String>,
    values: fn(Vec<T>) -> Values,
) -> Vec<Column> {
    let count = match *shape {
        [_, count] => count.clamp(1, MOST_COLUMNS),
        _ => 1,
    };
    let each = shape.get(1).copied().unwrap_or(1).max(1);
    let column = |i: usize| entries.iter().skip(i).step_by(each).copied().collect();
    names(count)
        .into_iter()
        .enumerate()
        .map(|(i, name)| Column::new(name, values(column(i))))
        .collect()
}
