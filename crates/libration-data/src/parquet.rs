//! Apache Parquet: columns, compressed, with their units in the file's metadata.
//!
//! The key `libration.units` holds a JSON object from column names to units. The file is written
//! with Parquet's own column writers: going through Arrow more than doubles the time to compile,
//! and buys a place for the units that few readers look at.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use bytes::Bytes;
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::column::writer::{ColumnCloseResult, ColumnWriter, get_column_writer};
use parquet::data_type::{ByteArray, FixedLenByteArray};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesPtr};
use parquet::file::writer::{SerializedFileWriter, SerializedPageWriter, TrackedWrite};
use parquet::schema::types::{ColumnDescPtr, ColumnPath, Type, TypePtr};

use crate::{Column, Table, TableError, Values};

/// Rows that are compressed, and can be skipped, together.
const ROW_GROUP: usize = 1 << 20;

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
        for column in on_threads(threads, columns.len(), encode) {
            let (bytes, close) = column?;
            group.append_column(&bytes, close)?;
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}

/// What `work` makes of each number below `count`, in their order.
fn on_threads<R: Send>(threads: usize, count: usize, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
    if threads < 2 || count < 2 {
        return (0..count).map(work).collect();
    }
    let results: Vec<Mutex<Option<R>>> = (0..count).map(|_| Mutex::new(None)).collect();
    let next = AtomicUsize::new(0);
    let drain = || {
        while let i = next.fetch_add(1, Ordering::Relaxed)
            && let Some(result) = results.get(i)
        {
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(work(i));
        }
    };
    thread::scope(|scope| {
        (1..threads.min(count)).for_each(|_| drop(scope.spawn(drain)));
        drain();
    });
    let taken =
        |result: Mutex<Option<R>>| result.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().filter_map(taken).collect()
}

/// A column of a row group by itself.
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
    write_values(&mut writer, values, start, end)?;
    let close = writer.close()?;
    Ok((out.into_inner()?.into(), close))
}

fn field(column: &Column<'_>) -> Result<TypePtr, ParquetError> {
    let unsigned = |bits| LogicalType::integer(bits, false);
    let (physical, logical) = match column.values {
        Values::U64(_) => (Physical::INT64, Some(unsigned(64))),
        Values::U32(_) => (Physical::INT32, Some(unsigned(32))),
        Values::Bool(_) => (Physical::BOOLEAN, None),
        Values::F64(_) => (Physical::DOUBLE, None),
        Values::F32(_) | Values::Bf16(_) => (Physical::FLOAT, None),
        Values::F16(_) => (Physical::FIXED_LEN_BYTE_ARRAY, Some(LogicalType::Float16)),
    };
    let mut builder = Type::primitive_type_builder(&column.name, physical)
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
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_key_value_metadata(Some(
            entries.map(|&(k, v)| KeyValue::new(k.to_owned(), v.to_owned())).collect(),
        ));
    for column in table.columns() {
        // A count rises by the same stride from row to row; a float compresses by its bytes.
        let encoding = match column.values {
            Values::U64(_) | Values::U32(_) => Encoding::DELTA_BINARY_PACKED,
            Values::Bool(_) => Encoding::RLE,
            _ => Encoding::BYTE_STREAM_SPLIT,
        };
        let path = ColumnPath::new(vec![column.name.to_string()]);
        builder = builder.set_column_encoding(path, encoding);
    }
    Ok(builder.build())
}

fn write_values(
    writer: &mut ColumnWriter<'_>,
    values: &Values<'_>,
    start: usize,
    end: usize,
) -> Result<(), ParquetError> {
    let rows = start..end;
    let count = match (values, writer) {
        (Values::F64(x), ColumnWriter::DoubleColumnWriter(to)) => {
            to.write_batch(&x[rows], None, None)?
        }
        (Values::F32(x), ColumnWriter::FloatColumnWriter(to)) => {
            to.write_batch(&x[rows], None, None)?
        }
        (Values::Bf16(x), ColumnWriter::FloatColumnWriter(to)) => {
            let wide: Vec<_> = x[rows].iter().map(|x| x.to_f32()).collect();
            to.write_batch(&wide, None, None)?
        }
        (Values::F16(x), ColumnWriter::FixedLenByteArrayColumnWriter(to)) => {
            // One piece of memory for all.
            let all =
                Bytes::from(x[rows].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
            let one =
                |i: usize| FixedLenByteArray::from(ByteArray::from(all.slice(2 * i..2 * i + 2)));
            let each: Vec<_> = (0..all.len() / 2).map(one).collect();
            to.write_batch(&each, None, None)?
        }
        (Values::U64(x), ColumnWriter::Int64ColumnWriter(to)) => {
            to.write_batch(bytemuck::cast_slice(&x[rows]), None, None)?
        }
        (Values::U32(x), ColumnWriter::Int32ColumnWriter(to)) => {
            to.write_batch(bytemuck::cast_slice(&x[rows]), None, None)?
        }
        (Values::Bool(x), ColumnWriter::BoolColumnWriter(to)) => {
            let flags: Vec<bool> = x[rows].iter().map(|&flag| flag != 0).collect();
            to.write_batch(&flags, None, None)?
        }
        _ => return Err(ParquetError::General("a column of another type".to_owned())),
    };
    debug_assert_eq!(count, end - start);
    Ok(())
}
