//! NumPy's own file format.
//!
//! The format is that of NumPy Enhancement Proposal 1 and `numpy.lib.format`: the magic string, a version, the length of a header,
//! the header as a Python dictionary padded to a multiple of 64 bytes (here of a page), and the numbers without padding, little-endian.

use std::io::{self, Write};

use crate::{Column, Table, Values};

const MAGIC: &[u8] = b"\x93NUMPY";
/// The numbers begin at a multiple of this: the format asks for 64, and who writes or maps whole pages gains by one.
const ALIGNMENT: usize = 4096;

/// All bytes before the numbers of an array of one type, as `<f4`, in the order of C.
pub fn npy_array(kind: &str, shape: &[usize]) -> Vec<u8> {
    npy_header(&format!("'{kind}'"), shape)
}

/// Writes `table` into `out` as a structured array, one record for each row: `f16` as NumPy's `float16`, `bf16` as `float32`.
///
/// # Errors
/// If `out` refuses.
pub fn write_npy(table: &Table<'_>, mut out: impl Write) -> io::Result<()> {
    let field = |c: &Column<'_>| match &c.values {
        Values::Lists(each, of) => format!("({}, '{}', ({each},)), ", quoted(&c.name), kind(of)),
        values => format!("({}, '{}'), ", quoted(&c.name), kind(values)),
    };
    let fields: String = table.columns().iter().map(field).collect();
    out.write_all(&npy_header(&format!("[{}]", fields.trim_end()), &[table.rows()]))?;
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
        Values::Bool(x) => record.push(x[row]),
        Values::U32(x) => record.extend(x[row].to_le_bytes()),
        Values::U64(x) => record.extend(x[row].to_le_bytes()),
        Values::F64(x) => record.extend(x[row].to_le_bytes()),
        Values::F32(x) => record.extend(x[row].to_le_bytes()),
        Values::F16(x) => record.extend(x[row].to_le_bytes()),
        Values::Bf16(x) => record.extend(x[row].to_f32().to_le_bytes()),
        Values::Lists(each, of) => {
            (row * each..(row + 1) * each).for_each(|i| append(record, of, i));
        }
    }
}

/// The type of a value, or of those in a list.
fn kind(values: &Values<'_>) -> &'static str {
    match values {
        Values::Bool(_) => "|b1",
        Values::U32(_) => "<u4",
        Values::U64(_) => "<u8",
        Values::F64(_) => "<f8",
        Values::F32(_) | Values::Bf16(_) => "<f4",
        Values::F16(_) => "<f2",
        Values::Lists(_, of) => kind(of),
    }
}

/// A Python string literal.
fn quoted(name: &str) -> String {
    let escaped = name.replace('\\', "\\\\").replace('\'', "\\'").replace('\n', "\\n");
    format!("'{escaped}'")
}

/// All bytes before the numbers: `description` is Python for the type of an element.
fn npy_header(description: &str, shape: &[usize]) -> Vec<u8> {
    // Python's tuple of one element ends with a comma.
    let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let shape = if shape.matches(',').count() > 1 {
        shape.trim_end_matches(", ")
    } else {
        shape.trim_end()
    };
    let mut text =
        format!("{{'descr': {description}, 'fortran_order': False, 'shape': ({shape}), }}");
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_is_what_the_format_says() {
        for (shape, tuple) in [(&[3, 4, 2][..], "(3, 4, 2)"), (&[5], "(5,)"), (&[], "()")] {
            let bytes = npy_array("<f4", shape);
            assert_eq!(bytes.len() % 64, 0);
            assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
            assert_eq!(usize::from(u16::from_le_bytes([bytes[8], bytes[9]])), bytes.len() - 10);
            let text = std::str::from_utf8(&bytes[10..]).unwrap();
            assert!(text.ends_with('\n'));
            assert_eq!(
                text.trim_end(),
                format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {tuple}, }}")
            );
        }
    }

    #[test]
    fn long_headers_and_other_alphabets_take_a_later_version() {
        let long: String = (0..5000).map(|i| format!("('c{i}', '<f8'), ")).collect();
        for (description, version) in [(format!("[{long}]"), 2), ("[('ω', '<f8'),]".into(), 3)] {
            let bytes = npy_header(&description, &[2]);
            assert_eq!(&bytes[6..8], &[version, 0]);
            assert_eq!(bytes.len() % 64, 0);
            let length = u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]);
            assert_eq!(length as usize, bytes.len() - 12);
        }
    }
}
