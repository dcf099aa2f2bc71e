//! Apache Parquet: columns, compressed, with their units in the file's metadata.
//!
//! The key `libration.units` holds a JSON object from column names to units. The file is written
//! with Parquet's own column writers: going through Arrow more than doubles the time to compile,
//! and buys a place for the units that few readers look at.

use std::io::Write;
use std::ops::Range;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::column::writer::{ColumnCloseResult, ColumnWriter, get_column_writer};
use parquet::data_type::{ByteArray, FixedLenByteArray};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesPtr};
use parquet::file::writer::{SerializedFileWriter, SerializedPageWriter, TrackedWrite};
use parquet::schema::types::{ColumnDescPtr, ColumnPath, Type, TypePtr};

use crate::{Column, Table, TableError, Values, run_on_threads};

/// Rows that are compressed, and can be skipped, together.
const ROW_GROUP: usize = 1 << 20;

/// Bytes of a compressor at level 1 with its window, and of the pages that it is given, each at most a megabyte.
const ENCODER: u128 = 8 << 20;

/// Writes `table` into `out`, with further `metadata` beside the units. So many threads encode its columns; the bytes do not
/// depend on how many.
///
/// `f16` is Parquet's `FLOAT16`; `bf16` is stored as `FLOAT`, which is exact.
///
/// # Errors
/// If `out` or the Parquet library refuses.
pub fn write_parquet(
    table: &Table<'_>,
    metadata: &[(&str, &str)],
    threads: usize,
    out: impl Write + Send,
) -> Result<(), TableError> {
    let fields = table.columns().iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("schema").with_fields(fields).build()?);
    let properties = Arc::new(properties(table, metadata)?);
    let mut file = SerializedFileWriter::new(out, schema, properties.clone())?;
    let columns = file.schema_descr().columns().to_vec();
    for start in (0..table.rows()).step_by(ROW_GROUP) {
        let end = table.rows().min(start + ROW_GROUP);
        let encode = |i: usize| {
            let values = &table.columns()[i].values;
            encoded(columns[i].clone(), properties.clone(), values, start, end)
        };
        let mut group = file.next_row_group()?;
        for column in run_on_threads(threads, columns.len(), encode) {
            let (bytes, close) = column?;
            group.append_column(&bytes, close)?;
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}

/// The largest memory of [`write_parquet`], in bytes, besides the table.
pub fn parquet_bytes(rows: u64, bytes: u128, threads: usize) -> u128 {
    // The columns of a row group are kept until it ends, and may be moved as they grow.
    let group = bytes * u128::from(rows.min(ROW_GROUP as u64)) / u128::from(rows.max(1));
    2 * group + threads as u128 * ENCODER
}

/// One column of a row group.
fn encoded(
    column: ColumnDescPtr,
    properties: WriterPropertiesPtr,
    values: &Values<'_>,
    start: usize,
    end: usize,
) -> Result<(Bytes, ColumnCloseResult), ParquetError> {
    // What is compressed is seldom longer: memory that grows is moved, and touched anew.
    let mut out = TrackedWrite::new(Vec::with_capacity((end - start) * values.width() / 2));
    let mut writer =
        get_column_writer(column, properties, Box::new(SerializedPageWriter::new(&mut out)));
    match values {
        Values::Lists(each, of) => {
            // None is absent, and the first of each list begins it.
            let count = (end - start) * each;
            let begins: Vec<i16> = (0..count).map(|i| i16::from(i % each != 0)).collect();
            let levels = (Some(&vec![1; count][..]), Some(&begins[..]));
            write_values(&mut writer, of, start * each..end * each, levels)?;
        }
        values => write_values(&mut writer, values, start..end, (None, None))?,
    }
    let close = writer.close()?;
    Ok((out.into_inner()?.into(), close))
}

fn field(column: &Column<'_>) -> Result<TypePtr, ParquetError> {
    let Values::Lists(_, of) = &column.values else {
        return number(&column.name, &column.values);
    };
    let [list, element] = LIST;
    let group = |name, repetition, field| {
        Type::group_type_builder(name).with_repetition(repetition).with_fields(vec![field])
    };
    let list = group(list, Repetition::REPEATED, number(element, of)?).build()?;
    let column = group(&column.name, Repetition::REQUIRED, Arc::new(list));
    Ok(Arc::new(column.with_logical_type(Some(LogicalType::List)).build()?))
}

/// The names that the format gives to what a list consists of.
const LIST: [&str; 2] = ["list", "element"];

/// A column of numbers, or what its lists consist of.
fn number(name: &str, values: &Values<'_>) -> Result<TypePtr, ParquetError> {
    let unsigned = |bits| LogicalType::integer(bits, false);
    let (physical, logical) = match values {
        Values::U64(_) => (Physical::INT64, Some(unsigned(64))),
        Values::U32(_) => (Physical::INT32, Some(unsigned(32))),
        Values::Bool(_) => (Physical::BOOLEAN, None),
        Values::F64(_) => (Physical::DOUBLE, None),
        Values::F32(_) | Values::Bf16(_) => (Physical::FLOAT, None),
        Values::F16(_) => (Physical::FIXED_LEN_BYTE_ARRAY, Some(LogicalType::Float16)),
        Values::Lists(..) => return Err(ParquetError::General("lists of lists".to_owned())),
    };
    let mut builder = Type::primitive_type_builder(name, physical)
        .with_repetition(Repetition::REQUIRED)
        .with_logical_type(logical);
    if physical == Physical::FIXED_LEN_BYTE_ARRAY {
        builder = builder.with_length(2);
    }
    Ok(Arc::new(builder.build()?))
}

fn properties(
    table: &Table<'_>,
    metadata: &[(&str, &str)],
) -> Result<WriterProperties, ParquetError> {
    let units: serde_json::Map<_, _> =
        table.columns().iter().map(|c| (c.name.to_string(), c.unit.as_ref().into())).collect();
    let units = serde_json::Value::Object(units).to_string();
    let entries = [("libration.units", units.as_str())];
    let entries = entries.iter().chain(metadata);
    let mut builder = WriterProperties::builder()
        .set_created_by(format!("libration {}", env!("CARGO_PKG_VERSION")))
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(1)?))
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_key_value_metadata(Some(
            entries.map(|&(k, v)| KeyValue::new(k.to_owned(), v.to_owned())).collect(),
        ));
    for column in table.columns() {
        // A count rises by the same stride from row to row; a float compresses by its bytes.
        let (values, within) = match &column.values {
            Values::Lists(_, of) => (&**of, &LIST[..]),
            values => (values, &[][..]),
        };
        let encoding = match values {
            Values::U64(_) | Values::U32(_) => Encoding::DELTA_BINARY_PACKED,
            Values::Bool(_) => Encoding::RLE,
            _ => Encoding::BYTE_STREAM_SPLIT,
        };
        let path = [&*column.name].into_iter().chain(within.iter().copied());
        let path = ColumnPath::new(path.map(str::to_owned).collect());
        if encoding == Encoding::DELTA_BINARY_PACKED {
            // By counts a reader finds its rows; of other numbers nearly every group has the same extremes.
            let statistics = EnabledStatistics::Chunk;
            builder = builder.set_column_statistics_enabled(path.clone(), statistics);
        }
        builder = builder.set_column_encoding(path, encoding);
    }
    Ok(builder.build())
}

/// Writes some values, with the levels of their lists if they are in any.
fn write_values(
    writer: &mut ColumnWriter<'_>,
    values: &Values<'_>,
    rows: Range<usize>,
    (there, begins): (Option<&[i16]>, Option<&[i16]>),
) -> Result<(), ParquetError> {
    let wanted = rows.len();
    let count = match (values, writer) {
        (Values::F64(x), ColumnWriter::DoubleColumnWriter(to)) => {
            to.write_batch(&x[rows], there, begins)?
        }
        (Values::F32(x), ColumnWriter::FloatColumnWriter(to)) => {
            to.write_batch(&x[rows], there, begins)?
        }
        (Values::Bf16(x), ColumnWriter::FloatColumnWriter(to)) => {
            let wide: Vec<_> = x[rows].iter().map(|x| x.to_f32()).collect();
            to.write_batch(&wide, there, begins)?
        }
        (Values::F16(x), ColumnWriter::FixedLenByteArrayColumnWriter(to)) => {
            // One piece of memory for all.
            let all =
                Bytes::from(x[rows].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
            let one =
                |i: usize| FixedLenByteArray::from(ByteArray::from(all.slice(2 * i..2 * i + 2)));
            let each: Vec<_> = (0..all.len() / 2).map(one).collect();
            to.write_batch(&each, there, begins)?
        }
        (Values::U64(x), ColumnWriter::Int64ColumnWriter(to)) => {
            to.write_batch(bytemuck::cast_slice(&x[rows]), there, begins)?
        }
        (Values::U32(x), ColumnWriter::Int32ColumnWriter(to)) => {
            to.write_batch(bytemuck::cast_slice(&x[rows]), there, begins)?
        }
        (Values::Bool(x), ColumnWriter::BoolColumnWriter(to)) => {
            let flags: Vec<bool> = x[rows].iter().map(|&flag| flag != 0).collect();
            to.write_batch(&flags, there, begins)?
        }
        _ => return Err(ParquetError::General("a column of another type".to_owned())),
    };
    debug_assert_eq!(count, wanted);
    Ok(())
}
