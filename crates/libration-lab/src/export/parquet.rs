//! Apache Parquet: columns, compressed, with their units in the file's metadata.
//!
//! The key `libration.units` holds a JSON object from column names to units. The file is written
//! with Parquet's own column writers: going through Arrow more than doubles the time to compile,
//! and buys a place for the units that few readers look at.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{
    ByteArray, DataType, DoubleType, FixedLenByteArray, FixedLenByteArrayType, FloatType, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type, TypePtr};

use super::{Column, ExportError, Table, Values};
use crate::record::Series;

/// Rows that are compressed, and can be skipped, together.
const ROW_GROUP: usize = 1 << 20;

/// The series as a Parquet file. NaN stays NaN.
///
/// # Errors
/// [`ExportError::Ragged`] if its columns differ in length.
pub fn series_to_parquet(series: &Series) -> Result<Vec<u8>, ExportError> {
    let mut bytes = Vec::new();
    write_parquet(&Table::try_from(series)?, &[("libration.series", &series.name)], &mut bytes)?;
    Ok(bytes)
}

/// Writes `table` into `out`, with further `metadata` beside the units.
///
/// `f16` is Parquet's `FLOAT16`; `bf16` is stored as `FLOAT`, which is exact.
///
/// # Errors
/// If `out` or the Parquet library refuses.
pub fn write_parquet(
    table: &Table<'_>,
    metadata: &[(&str, &str)],
    out: impl Write + Send,
) -> Result<(), ExportError> {
    let fields = table.columns().iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("schema").with_fields(fields).build()?);
    let properties = Arc::new(properties(table, metadata)?);
    let mut file = SerializedFileWriter::new(out, schema, properties)?;
    for start in (0..table.rows()).step_by(ROW_GROUP) {
        let end = table.rows().min(start + ROW_GROUP);
        let mut group = file.next_row_group()?;
        for column in table.columns() {
            if let Some(mut writer) = group.next_column()? {
                write_values(&mut writer, &column.values, start, end)?;
                writer.close()?;
            }
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}

fn field(column: &Column<'_>) -> Result<TypePtr, ParquetError> {
    let unsigned = LogicalType::integer(64, false);
    let (physical, logical) = match column.values {
        Values::U64(_) => (Physical::INT64, Some(unsigned)),
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
            Values::U64(_) => Encoding::DELTA_BINARY_PACKED,
            _ => Encoding::BYTE_STREAM_SPLIT,
        };
        let path = ColumnPath::new(vec![column.name.to_string()]);
        builder = builder.set_column_encoding(path, encoding);
    }
    Ok(builder.build())
}

fn write_values(
    writer: &mut SerializedColumnWriter<'_>,
    values: &Values<'_>,
    start: usize,
    end: usize,
) -> Result<(), ParquetError> {
    match values {
        Values::F64(x) => write_batch::<DoubleType>(writer, &x[start..end]),
        Values::F32(x) => write_batch::<FloatType>(writer, &x[start..end]),
        Values::U64(x) => {
            let signed: Vec<_> = x[start..end].iter().map(|x| x.cast_signed()).collect();
            write_batch::<Int64Type>(writer, &signed)
        }
        Values::F16(x) => {
            let bytes =
                |x: &half::f16| FixedLenByteArray::from(ByteArray::from(x.to_le_bytes().to_vec()));
            let bytes: Vec<_> = x[start..end].iter().map(bytes).collect();
            write_batch::<FixedLenByteArrayType>(writer, &bytes)
        }
        Values::Bf16(x) => {
            let wide: Vec<_> = x[start..end].iter().map(|x| x.to_f32()).collect();
            write_batch::<FloatType>(writer, &wide)
        }
    }
}

fn write_batch<T: DataType>(
    writer: &mut SerializedColumnWriter<'_>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    writer.typed::<T>().write_batch(values, None, None).map(|_| ())
}
