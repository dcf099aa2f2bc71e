//! Reading structured arrays of NumPy: a record of named fields for each row, as `write_npy` writes them.

use super::byte_reader::ByteReader;
use super::npy::{header, number_format, shape, value};
use super::number_format::NumberFormat;
use super::{ArrayValues, NamedArray, push_new};

/// A field of a record.
struct Field {
    name: String,
    /// None of a field without numbers, such as text.
    format: Option<NumberFormat>,
    /// Bytes of a number.
    size: usize,
    /// Numbers of the field.
    count: usize,
}

/// The fields of a file `.npy` with a structured array of one dimension, in their order; none if the array is not structured. A field
/// with several numbers is a matrix. Fields without numbers, and those of two bytes, are left out.
///
/// # Errors
/// The error in words: a damaged file, or nested fields.
pub fn parse_npy_records(bytes: &[u8]) -> Result<Option<Vec<NamedArray>>, String> {
    let mut reader = ByteReader::little_endian(bytes);
    let header = header(&mut reader)?;
    let Some(list) = value(header, "descr")?.strip_prefix('[') else { return Ok(None) };
    let fields = fields(list)?;
    let shape = shape(value(header, "shape")?)?;
    let [rows] = shape[..] else {
        return Err(format!("it has records in the shape {shape:?}; expected one dimension"));
    };
    let width = fields.iter().try_fold(0_usize, |sum, field| {
        field.size.checked_mul(field.count).and_then(|bytes| sum.checked_add(bytes))
    });
    let content = reader.rest();
    let width = width.filter(|width| *width > 0 && width.checked_mul(rows) == Some(content.len()));
    let Some(width) = width else {
        return Err(format!("it has {} bytes of records; expected {rows} records", content.len()));
    };
    let mut arrays = Vec::new();
    let mut at = 0;
    for field in fields {
        let length = field.size * field.count;
        let Some(format) = field.format else {
            at += length;
            continue;
        };
        let column: Vec<u8> = content
            .chunks_exact(width)
            .flat_map(|record| &record[at..at + length])
            .copied()
            .collect();
        at += length;
        let shape = if field.count == 1 { vec![rows] } else { vec![rows, field.count] };
        let values = match format.decode(&column, &shape) {
            Ok(entries) => ArrayValues::Numbers { shape, entries },
            Err(why) => {
                let entries = format.decode_integers(&column, &shape).ok_or(why)?;
                ArrayValues::Integers { shape, entries }
            }
        };
        push_new(&mut arrays, NamedArray { name: field.name, values })?;
    }
    Ok(Some(arrays))
}

/// The fields of `('name', '<f8'), ('list', '<f4', (3,)), ]`.
fn fields(mut text: &str) -> Result<Vec<Field>, String> {
    let wrong = || "its header has a dtype that is not a list of names and numbers".to_owned();
    let mut fields = Vec::new();
    loop {
        text = text.trim_start_matches([',', ' ']);
        if text.starts_with(']') {
            return Ok(fields);
        }
        let rest = text.strip_prefix("('").ok_or_else(wrong)?;
        let (name, rest) = rest.split_once('\'').ok_or_else(wrong)?;
        let rest = rest.trim_start_matches([',', ' ']).strip_prefix('\'').ok_or_else(wrong)?;
        let (dtype, rest) = rest.split_once('\'').ok_or_else(wrong)?;
        let rest = rest.trim_start_matches([',', ' ']);
        let (count, rest) = match rest.strip_prefix('(') {
            Some(_) => {
                let lengths = shape(rest)?;
                let count = lengths.iter().try_fold(1_usize, |all, &n| all.checked_mul(n));
                (count.ok_or_else(wrong)?, rest.split_once(')').map_or("", |(_, rest)| rest))
            }
            None => (1, rest),
        };
        text = rest.trim_start_matches(' ').strip_prefix(')').ok_or_else(wrong)?;
        let size = dtype.get(2..).and_then(|size| size.parse().ok()).ok_or_else(wrong)?;
        // Characters of text have four bytes.
        let size = if dtype.get(1..2) == Some("U") { 4 * usize::min(size, 1 << 20) } else { size };
        let format = number_format(dtype);
        fields.push(Field { name: name.to_owned(), format, size, count });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Column, Table, Values, write_npy};

    #[test]
    fn records_that_were_written_are_read() {
        let column =
            |name: &'static str, values| Column { name: name.into(), unit: "1".into(), values };
        let list = Values::Lists(2, Box::new(Values::F32(vec![1.0, 2.0, 3.0, 4.0].into())));
        let table = Table::new(vec![
            column("step", Values::U64(vec![1, u64::MAX >> 1].into())),
            column("x", Values::F64(vec![0.5, -1.0].into())),
            column("pair", list),
            column("on", Values::Bool(vec![1, 0].into())),
        ])
        .unwrap();
        let mut bytes = Vec::new();
        write_npy(&table, &mut bytes).unwrap();
        let arrays = parse_npy_records(&bytes).unwrap().unwrap();
        let names: Vec<_> = arrays.iter().map(|array| array.name.as_str()).collect();
        assert_eq!(names, ["step", "x", "pair", "on"]);
        let numbers = |shape: &[usize], entries: &[f64]| ArrayValues::Numbers {
            shape: shape.to_vec(),
            entries: entries.to_vec(),
        };
        let whole = ArrayValues::Integers { shape: vec![2], entries: vec![1, i64::MAX] };
        assert_eq!(arrays[0].values, whole);
        assert_eq!(arrays[1].values, numbers(&[2], &[0.5, -1.0]));
        assert_eq!(arrays[2].values, numbers(&[2, 2], &[1.0, 2.0, 3.0, 4.0]));
        assert_eq!(arrays[3].values, numbers(&[2], &[1.0, 0.0]));
        for length in 0..bytes.len() {
            assert!(parse_npy_records(&bytes[..length]).is_err(), "{length}");
        }
    }
}
