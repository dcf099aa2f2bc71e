//! Reading NumPy's own file format, of NumPy Enhancement Proposal 1 and `numpy.lib.format`.

use super::byte_reader::ByteReader;
use super::number_format::{NumberFormat, NumberKind};
use super::{ArrayValues, by_rows};

/// The array of a file `.npy`, versions 1 to 3: floats of 4 and 8 bytes, integers, and strings.
///
/// # Errors
/// The error in words: a damaged file, or an array that has neither real numbers nor strings.
pub fn parse_npy(bytes: &[u8]) -> Result<ArrayValues, String> {
    let mut reader = ByteReader::little_endian(bytes);
    let header = header(&mut reader)?;
    let dtype = value(header, "descr")?;
    let dtype = dtype.strip_prefix('\'').and_then(|rest| rest.split_once('\''));
    let (dtype, _) = dtype.ok_or("it is a structured array; expected numbers")?;
    let is_by_columns = value(header, "fortran_order")?.starts_with("True");
    let shape = shape(value(header, "shape")?)?;
    if shape.len() > 2 {
        return Err(format!("it has the shape {shape:?}; expected at most two dimensions"));
    }
    let ordered = |entries: Vec<f64>| match is_by_columns {
        true => by_rows(&entries, &shape),
        false => entries,
    };
    let unknown = || format!("it has the dtype `{dtype}`; expected a real number, as `float64`");
    if let Some((order, size)) = dtype.split_once('U') {
        let size = size.parse::<usize>().map_err(|_| unknown())?;
        return text(reader.rest(), &shape, size, order == ">");
    }
    let format = number_format(dtype).ok_or_else(unknown)?;
    let entries = match (format.decode(reader.rest(), &shape), is_by_columns) {
        (Ok(entries), _) => entries,
        (Err(why), false) => {
            let entries = format.decode_integers(reader.rest(), &shape).ok_or(why)?;
            return Ok(ArrayValues::Integers { entries, shape });
        }
        (Err(why), true) => return Err(why),
    };
    Ok(ArrayValues::Numbers { entries: ordered(entries), shape })
}

/// The header, which is a Python dictionary.
pub(super) fn header<'a>(reader: &mut ByteReader<'a>) -> Result<&'a str, String> {
    if reader.take(6).ok() != Some(b"\x93NUMPY") {
        return Err("it does not begin as a NumPy array".to_owned());
    }
    let version = reader.take(2)?[0];
    let length = match version {
        1 => reader.u16()?,
        2 | 3 => reader.u32()?,
        _ => return Err(format!("it has version {version} of .npy; expected 1, 2 or 3")),
    };
    Ok(std::str::from_utf8(reader.take(length)?).map_err(|_| "its header is no text")?)
}

/// The format of numbers of a dtype such as `<f8`; none of others.
pub(super) fn number_format(dtype: &str) -> Option<NumberFormat> {
    let (code, size) = dtype.split_at_checked(2)?;
    let kind = match code.get(1..2)? {
        "f" => NumberKind::Float,
        "i" => NumberKind::Signed,
        "u" | "b" => NumberKind::Unsigned,
        _ => return None,
    };
    NumberFormat::new(kind, size.parse().ok()?, code.starts_with('>'))
}

/// What follows a key in the header, which is a Python dictionary.
pub(super) fn value<'a>(header: &'a str, key: &str) -> Result<&'a str, String> {
    let rest = header.split_once(&format!("'{key}'")).map(|(_, rest)| rest.trim_start());
    let value = rest.and_then(|rest| rest.strip_prefix(':'));
    value.map(str::trim_start).ok_or_else(|| format!("its header has no key `{key}`"))
}

/// A Python tuple of integers.
pub(super) fn shape(text: &str) -> Result<Vec<usize>, String> {
    let inner = text.strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let (inner, _) = inner.ok_or("its header has no shape")?;
    let numbers = inner.split(',').map(str::trim).filter(|number| !number.is_empty());
    let shape = numbers.map(str::parse).collect::<Result<_, _>>();
    shape.map_err(|_| format!("its header has the shape ({inner})"))
}

/// Strings of `size` characters of four bytes, padded with zeros.
fn text(
    bytes: &[u8],
    shape: &[usize],
    size: usize,
    big_endian: bool,
) -> Result<ArrayValues, String> {
    let length = size.checked_mul(4).filter(|&length| length > 0);
    let length = length.ok_or("its strings are empty")?;
    let count: Option<usize> =
        shape.iter().try_fold(1, |product: usize, &n| product.checked_mul(n));
    if count.and_then(|count| count.checked_mul(length)) != Some(bytes.len()) || shape.len() > 1 {
        return Err("it has strings in another shape than that of a list".to_owned());
    }
    let string = |bytes: &[u8]| {
        let mut reader = ByteReader::new(bytes, big_endian);
        let codes = std::iter::from_fn(|| reader.u32().ok()).take_while(|&code| code > 0);
        let characters = codes.map(|code| char::from_u32(code as u32));
        characters.collect::<Option<String>>().ok_or("it has a string that is no Unicode")
    };
    let strings = bytes.chunks_exact(length).map(string).collect::<Result<_, _>>()?;
    Ok(ArrayValues::Text(strings))
}
