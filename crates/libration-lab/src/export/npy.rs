//! NumPy's own file format: a structured array, one record for each row.
//!
//! `numpy.load(file)["q0"]` is then a column. The format is that of NumPy Enhancement Proposal 1
//! and `numpy.lib.format`: the magic string, a version, the length of a header, the header as a
//! Python dictionary padded to a multiple of 64 bytes, and the records without padding.

use std::io::Write;

use super::{Column, ExportError, Table, Values};

const MAGIC: &[u8] = b"\x93NUMPY";
/// The array data begin at a multiple of this.
const ALIGNMENT: usize = 64;

/// Writes `table` into `out`, little-endian; `f16` as NumPy's `float16`, `bf16` as `float32`.
///
/// # Errors
/// If `out` refuses.
pub fn write_npy(table: &Table<'_>, mut out: impl Write) -> Result<(), ExportError> {
    out.write_all(&header(table))?;
    let mut record = Vec::new();
    for row in 0..table.rows() {
        record.clear();
        for column in table.columns() {
            append(&mut record, &column.values, row);
        }
        out.write_all(&record)?;
    }
    Ok(())
}

fn append(record: &mut Vec<u8>, values: &Values<'_>, row: usize) {
    match values {
        Values::U64(x) => record.extend(x[row].to_le_bytes()),
        Values::F64(x) => record.extend(x[row].to_le_bytes()),
        Values::F32(x) => record.extend(x[row].to_le_bytes()),
        Values::F16(x) => record.extend(x[row].to_le_bytes()),
        Values::Bf16(x) => record.extend(x[row].to_f32().to_le_bytes()),
    }
}

const fn dtype(values: &Values<'_>) -> &'static str {
    match values {
        Values::U64(_) => "<u8",
        Values::F64(_) => "<f8",
        Values::F32(_) | Values::Bf16(_) => "<f4",
        Values::F16(_) => "<f2",
    }
}

/// All bytes before the records.
fn header(table: &Table<'_>) -> Vec<u8> {
    let field = |c: &Column<'_>| format!("({}, '{}'), ", quoted(&c.name), dtype(&c.values));
    let fields: String = table.columns().iter().map(field).collect();
    let mut text = format!(
        "{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}",
        fields.trim_end(),
        table.rows()
    );
    // Version 1.0 counts the header in 2 bytes, 2.0 in 4, and 3.0 is 2.0 in UTF-8.
    let version: u8 = match text.len() {
        _ if !text.is_ascii() => 3,
        length if length > usize::from(u16::MAX) - ALIGNMENT => 2,
        _ => 1,
    };
    let prefix = MAGIC.len() + 2 + if version == 1 { 2 } else { 4 };
    let total = (prefix + text.len() + 1).next_multiple_of(ALIGNMENT);
    let length = total - prefix;
    text.extend(std::iter::repeat_n(' ', length - 1 - text.len()));
    text.push('\n');

    let mut bytes = MAGIC.to_vec();
    bytes.extend([version, 0]);
    // The first two of four little-endian bytes are the two of version 1.0.
    bytes.extend(&(length as u32).to_le_bytes()[..prefix - MAGIC.len() - 2]);
    bytes.extend(text.as_bytes());
    bytes
}

/// A Python string literal.
fn quoted(name: &str) -> String {
    let escaped = name.replace('\\', "\\\\").replace('\'', "\\'").replace('\n', "\\n");
    format!("'{escaped}'")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::borrow::Cow;

    fn table(names: impl IntoIterator<Item = String>) -> Table<'static> {
        let column = |name| Column {
            name: Cow::Owned(name),
            unit: "1".into(),
            values: Values::F64(vec![1.0, f64::NAN].into()),
        };
        Table::new(names.into_iter().map(column).collect()).unwrap()
    }

    #[test]
    fn the_header_is_what_the_format_says() {
        let bytes = header(&table(["t".into(), "it's".into()]));
        assert_eq!(bytes.len() % 64, 0);
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        assert_eq!(usize::from(u16::from_le_bytes([bytes[8], bytes[9]])), bytes.len() - 10);
        let text = std::str::from_utf8(&bytes[10..]).unwrap();
        assert!(text.ends_with(" \n") || text.ends_with("}\n"));
        assert_eq!(
            text.trim_end(),
            r"{'descr': [('t', '<f8'), ('it\'s', '<f8'),], 'fortran_order': False, 'shape': (2,), }"
        );
    }

    #[test]
    fn long_headers_and_other_alphabets_take_a_later_version() {
        for (table, version) in
            [(table((0..5000).map(|i| format!("c{i}"))), 2), (table(["ω".into()]), 3)]
        {
            let bytes = header(&table);
            assert_eq!(&bytes[6..8], &[version, 0]);
            assert_eq!(bytes.len() % 64, 0);
            let length = u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]);
            assert_eq!(length as usize, bytes.len() - 12);
        }
    }
}
