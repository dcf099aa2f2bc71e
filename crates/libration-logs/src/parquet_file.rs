//! Apache Parquet.

use std::fs::File;
use std::thread::Builder;

use parquet::basic::{LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::arrow_schema;
use crate::column::{Column, MISSING, Values, missing};
use crate::error::LogError;
use crate::input::Input;
use crate::read_options::ReadOptions;
use crate::table::Table;

/// Records that are read at once.
const BATCH: usize = 1 << 16;
/// Largest number of cells in memory: 2 GiB of numbers.
const MOST_CELLS: u64 = 1 << 28;
/// Cells that any file may have.
const LEAST_CELLS: u64 = 1 << 20;
/// Most cells for each byte of a file: one number that repeats takes nearly no bytes, but a recording has others beside it.
const CELLS_OF_BYTE: u64 = 32;

impl From<ParquetError> for LogError {
    fn from(error: ParquetError) -> Self {
        LogError::Damaged(format!("it cannot be read as Parquet: {error}"))
    }
}

/// The name of the thread that reads a Parquet file: the library panics on some damaged files, and a panic on this thread is an error
/// of the file. A hook that reports panics ignores those of this thread.
pub const PARQUET_THREAD: &str = "parquet";

/// Reads the columns of numbers. Lists and text are left out.
pub(crate) fn open(input: &Input, options: &ReadOptions) -> Result<Table, LogError> {
    let most = input.len()?.saturating_mul(CELLS_OF_BYTE).clamp(LEAST_CELLS, MOST_CELLS);
    let (input, options) = (input.clone(), options.clone());
    let reading = move || match input {
        Input::File(path) => read(&SerializedFileReader::new(File::open(path)?)?, most, &options),
        Input::Memory(bytes) => read(&SerializedFileReader::new(bytes)?, most, &options),
    };
    let thread = Builder::new().name(PARQUET_THREAD.to_owned()).spawn(reading)?;
    thread.join().unwrap_or_else(|_| {
        Err(LogError::Damaged("it is damaged: the Parquet library cannot read it".to_owned()))
    })
}

fn read(reader: &dyn FileReader, most: u64, options: &ReadOptions) -> Result<Table, LogError> {
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let units = units(reader);
    let durations = metadata(reader, "ARROW:schema").map_or_else(Vec::new, arrow_schema::durations);
    let (mut columns, mut ignored, mut cells) = (Vec::new(), Vec::new(), Cells { count: 0, most });
    let mut empty = Vec::new();
    for (index, descriptor) in schema.columns().iter().enumerate() {
        let name = descriptor.path().string();
        if descriptor.max_rep_level() > 0 {
            ignored.push(format!("`{name}` is a list: ignored"));
            continue;
        }
        let Some(values) = values(reader, index, descriptor, &mut cells)? else {
            ignored.push(format!("`{name}` has no numbers: ignored"));
            empty.push(name);
            continue;
        };
        let unit = units.iter().find(|(column, _)| *column == name).map(|(_, unit)| unit.clone());
        let duration = durations.iter().find(|(column, _)| *column == name).map(|found| found.1);
        let mut column = Column::new(name, values);
        column.unit = unit.or(column.unit);
        column.per_second = per_second(descriptor).or(duration);
        columns.push(column);
    }
    Table::check_time(&columns, &empty, options)?;
    Ok(Table::new("Parquet", columns, options, Vec::new())?.with_ignored(ignored))
}

/// The text of a key of the file.
fn metadata<'a>(reader: &'a dyn FileReader, key: &str) -> Option<&'a str> {
    let entries = reader.metadata().file_metadata().key_value_metadata()?;
    entries.iter().find(|entry| entry.key == key)?.value.as_deref()
}

/// The units that `libration` writes.
fn units(reader: &dyn FileReader) -> Vec<(String, String)> {
    let text = metadata(reader, "libration.units");
    let map: Option<std::collections::BTreeMap<String, String>> =
        text.and_then(|text| serde_json::from_str(text).ok());
    map.unwrap_or_default().into_iter().filter(|(_, unit)| unit != "1").collect()
}

/// The number of units of time per second.
fn per_second(descriptor: &ColumnDescriptor) -> Option<f64> {
    let unit = match descriptor.logical_type_ref()? {
        LogicalType::Timestamp(time) => time.unit,
        LogicalType::Time(time) => time.unit,
        _ => return None,
    };
    Some(match unit {
        TimeUnit::MILLIS => 1e3,
        TimeUnit::MICROS => 1e6,
        TimeUnit::NANOS => 1e9,
    })
}

/// The cells so far.
struct Cells {
    count: u64,
    most: u64,
}

impl Cells {
    fn add(&mut self, count: u64) -> Result<(), LogError> {
        self.count = self.count.saturating_add(count);
        match self.count > self.most {
            true => Err(LogError::TooLarge {
                what: "number of cells of a file of this size",
                value: self.count,
                limit: self.most,
            }),
            false => Ok(()),
        }
    }
}

/// The values of a column in all row groups; none if they are no numbers.
fn values(
    reader: &dyn FileReader,
    index: usize,
    descriptor: &ColumnDescriptor,
    cells: &mut Cells,
) -> Result<Option<Values>, LogError> {
    let level = descriptor.max_def_level();
    let unsigned = matches!(descriptor.logical_type_ref(), Some(LogicalType::Integer(integer)) if !integer.is_signed);
    let (mut whole, mut floats) = (Vec::new(), Vec::new());
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        // The library asserts these of any file.
        let chunk = group.metadata().column(index);
        let start = chunk.dictionary_page_offset().unwrap_or_else(|| chunk.data_page_offset());
        if start < 0 || chunk.compressed_size() < 0 || chunk.num_values() < 0 {
            return Err(LogError::Damaged("the place of a column is below zero".to_owned()));
        }
        let column = group.get_column_reader(index)?;
        match column {
            ColumnReader::BoolColumnReader(column) => {
                collect(column, level, cells, &mut whole, MISSING, i64::from)?;
            }
            ColumnReader::Int32ColumnReader(column) => {
                let wide = |x: i32| if unsigned { i64::from(x as u32) } else { i64::from(x) };
                collect(column, level, cells, &mut whole, MISSING, wide)?;
            }
            ColumnReader::Int64ColumnReader(column) => {
                collect(column, level, cells, &mut whole, MISSING, |x| x)?;
            }
            ColumnReader::FloatColumnReader(column) => {
                collect(column, level, cells, &mut floats, missing(), f64::from)?;
            }
            ColumnReader::DoubleColumnReader(column) => {
                collect(column, level, cells, &mut floats, missing(), |x| x)?;
            }
            _ => return Ok(None),
        }
    }
    let is_float = matches!(
        descriptor.physical_type(),
        parquet::basic::Type::FLOAT | parquet::basic::Type::DOUBLE
    );
    Ok(Some(if is_float { Values::Floats(floats) } else { Values::Whole(whole) }))
}

/// Appends the values of a column of a row group, with `absent` where there is none.
fn collect<D: DataType, T: Copy>(
    mut reader: ColumnReaderImpl<D>,
    level: i16,
    cells: &mut Cells,
    out: &mut Vec<T>,
    absent: T,
    convert: impl Fn(D::T) -> T,
) -> Result<(), LogError> {
    loop {
        let (mut levels, mut values) = (Vec::new(), Vec::new());
        let to = (level > 0).then_some(&mut levels);
        let (records, _, _) = reader.read_records(BATCH, to, None, &mut values)?;
        if records == 0 {
            return Ok(());
        }
        cells.add(records as u64)?;
        let mut values = values.into_iter();
        match level {
            0 => out.extend(values.map(&convert)),
            _ => out.extend(levels.iter().map(|&own| match own == level {
                true => values.next().map_or(absent, &convert),
                false => absent,
            })),
        }
    }
}
