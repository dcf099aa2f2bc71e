//! Reading files of MATLAB, versions 5 to 7.
//!
//! Source: *MAT-File Format*, The MathWorks, chapter 1: a header of 128 bytes, and elements with a type and a length, of which version
//! 7 compresses those at the top.

use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_zlib_with_limit};

use super::byte_reader::ByteReader;
use super::number_format::{NumberFormat, NumberKind};
use super::{ArrayValues, NamedArray, by_rows, push_new};

const HEADER_BYTES: usize = 128;
const SAVE: &str =
    "help: save the file in MATLAB with save('plant.mat', 'A', 'B', 'C', 'D', '-v7')";

/// Types of elements.
const INT32: usize = 5;
const UINT32: usize = 6;
const MATRIX: usize = 14;
const COMPRESSED: usize = 15;

/// The variables of a file `.mat` of version 5, 6 or 7, in their order.
///
/// All variables that are compressed have together at most `limit` bytes.
///
/// # Errors
/// The error in words, with the name of the variable: another version, a damaged file, one that is too large, or a variable that is
/// not a real matrix.
pub fn read_mat(bytes: &[u8], limit: usize) -> Result<Vec<NamedArray>, String> {
    let big_endian = header(bytes)?;
    let mut reader = ByteReader::new(&bytes[HEADER_BYTES..], big_endian);
    let mut arrays = Vec::new();
    let mut left = limit;
    while !reader.rest().is_empty() {
        let (mut kind, mut data) = element(&mut reader)?;
        let content;
        if kind == COMPRESSED {
            content = decompress_to_vec_zlib_with_limit(data, left).map_err(|error| match error
                .status
            {
                TINFLStatus::HasMoreOutput => {
                    format!(
                        "its compressed variables are too large; expected at most {limit} bytes"
                    )
                }
                _ => "its compressed bytes are damaged".to_owned(),
            })?;
            left -= content.len();
            (kind, data) = element(&mut ByteReader::new(&content, big_endian))?;
        }
        if kind != MATRIX {
            return Err(format!("it has an element of type {kind}; expected a matrix"));
        }
        if let Some(array) = matrix(ByteReader::new(data, big_endian))? {
            push_new(&mut arrays, array)?;
        }
    }
    Ok(arrays)
}

/// Whether numbers begin with their highest byte.
fn header(bytes: &[u8]) -> Result<bool, String> {
    if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(b"\x89HDF") {
        return Err(format!("it has version 7.3, which is HDF5; expected version 5 to 7; {SAVE}"));
    }
    let unknown = || format!("it is not a MATLAB file of version 5 to 7; {SAVE}");
    let end = bytes.get(HEADER_BYTES - 4..HEADER_BYTES).ok_or_else(unknown)?;
    match end {
        [0, 1, b'I', b'M'] => Ok(false),
        [1, 0, b'M', b'I'] => Ok(true),
        _ => Err(unknown()),
    }
}

/// The type and the data of the next element.
fn element<'a>(reader: &mut ByteReader<'a>) -> Result<(usize, &'a [u8]), String> {
    let word = reader.u32()?;
    // A small element has its length in the upper half of the first word, and its data in the second.
    let (kind, small) = (word & 0xFFFF, word >> 16);
    if small > 0 {
        let data = reader.take(4)?.get(..small);
        return data
            .map(|data| (kind, data))
            .ok_or_else(|| format!("it has a small element of {small} bytes; expected at most 4"));
    }
    let length = reader.u32()?;
    let data = reader.take(length)?;
    if kind != COMPRESSED {
        reader.skip_up_to(length.wrapping_neg() % 8);
    }
    Ok((kind, data))
}

/// A variable; `None` for the data of MATLAB's own that have no name.
fn matrix(mut reader: ByteReader<'_>) -> Result<Option<NamedArray>, String> {
    let big_endian = reader.is_big_endian();
    let (kind, flags) = element(&mut reader)?;
    let flags = ByteReader::new(flags, big_endian).u32().ok().filter(|_| kind == UINT32);
    let flags = flags.ok_or("a variable has no flags")?;
    let class = flags & 0xFF;
    // An object of a class of MATLAB has no dimensions.
    let mut shape = Vec::new();
    if class != OPAQUE {
        let (kind, lengths) = element(&mut reader)?;
        if kind != INT32 || lengths.len() % 4 > 0 {
            return Err("a variable has no dimensions".to_owned());
        }
        let mut lengths = ByteReader::new(lengths, big_endian);
        shape.extend(std::iter::from_fn(|| lengths.u32().ok()));
    }
    let (_, name) = element(&mut reader)?;
    let name = String::from_utf8_lossy(name).into_owned();
    if name.is_empty() {
        return Ok(None);
    }
    let values = values(reader, flags, shape).map_err(|why| format!("variable `{name}`: {why}"))?;
    Ok(Some(NamedArray { name, values }))
}

const OPAQUE: usize = 17;

/// The numbers of a variable, which are stored by columns.
fn values(
    mut reader: ByteReader<'_>,
    flags: usize,
    shape: Vec<usize>,
) -> Result<ArrayValues, String> {
    let object = "help: save its matrices, [A, B, C, D] = ssdata(model)";
    match flags & 0xFF {
        6..=15 => {}
        4 => return Err("it is a text; expected a real matrix".to_owned()),
        5 => return Err("it is sparse; expected a full matrix; help: full(…)".to_owned()),
        1 => return Err("it is a cell array; expected a real matrix".to_owned()),
        2 => return Err(format!("it is a structure; expected a real matrix; {object}")),
        _ => return Err(format!("it is an object; expected a real matrix; {object}")),
    }
    if flags & 0x800 > 0 {
        return Err("it is complex; expected a real matrix".to_owned());
    }
    if flags & 0x200 > 0 {
        return Err("it is logical; expected a real matrix".to_owned());
    }
    if shape.len() != 2 {
        return Err(format!("it has {} dimensions; expected two", shape.len()));
    }
    let (kind, data) = element(&mut reader)?;
    let (code, size) = match kind {
        1 => (NumberKind::Signed, 1),
        2 => (NumberKind::Unsigned, 1),
        3 => (NumberKind::Signed, 2),
        4 => (NumberKind::Unsigned, 2),
        INT32 => (NumberKind::Signed, 4),
        UINT32 => (NumberKind::Unsigned, 4),
        7 => (NumberKind::Float, 4),
        9 => (NumberKind::Float, 8),
        12 => (NumberKind::Signed, 8),
        13 => (NumberKind::Unsigned, 8),
        _ => return Err(format!("its numbers have the type {kind}; expected 1 to 7, 9, 12 or 13")),
    };
    let format = NumberFormat::new(code, size, reader.is_big_endian());
    let format = format.ok_or("its numbers have an unknown size")?;
    let columns = format.decode(data, &shape)?;
    Ok(ArrayValues::Numbers { entries: by_rows(&columns, &shape), shape })
}
