//! Durations in the schema of Arrow that `pyarrow` and others keep in a Parquet file, whose own types have none.
//!
//! The value of the key `ARROW:schema` is a message of Arrow in base64: a FlatBuffer of the tables in
//! <https://github.com/apache/arrow/tree/main/format>.

/// The number of `Duration` in the union `Type`.
const DURATION: u8 = 18;
/// The number of `Schema` in the union `MessageHeader`.
const SCHEMA: u8 = 1;
/// Most fields.
const MOST: usize = 1 << 16;

/// The names of the columns of durations, each with its number of units per second; none where the schema cannot be read.
pub(crate) fn durations(base64: &str) -> Vec<(String, f64)> {
    decode(base64).and_then(|bytes| of_message(&bytes)).unwrap_or_default()
}

fn of_message(bytes: &[u8]) -> Option<Vec<(String, f64)>> {
    // A marker and the length are in front; old writers leave the marker out.
    let message = match bytes.strip_prefix(&[0xff; 4]) {
        Some(rest) => rest.get(4..)?,
        None => bytes.get(4..)?,
    };
    let message = Table::root(message)?;
    if message.byte(1)? != SCHEMA {
        return None;
    }
    let (fields, count) = message.table(2)?.vector(1)?;
    let field = |i: usize| {
        let field = fields.follow(4 * i)?;
        if field.byte(2)? != DURATION {
            return None;
        }
        let per_second = match field.table(3)?.short(0) {
            Some(0) => 1.0,
            // The default is left out.
            None | Some(1) => 1e3,
            Some(2) => 1e6,
            Some(3) => 1e9,
            Some(_) => return None,
        };
        Some((field.text(0)?, per_second))
    };
    Some((0..count.min(MOST)).filter_map(field).collect())
}

/// A place in a FlatBuffer: that of a table, or of the entries of a vector.
#[derive(Clone, Copy)]
struct Table<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Table<'a> {
    fn root(bytes: &'a [u8]) -> Option<Self> {
        Table { bytes, at: 0 }.follow(0)
    }

    fn array<const N: usize>(&self, at: usize) -> Option<[u8; N]> {
        self.bytes.get(at..)?.first_chunk().copied()
    }

    /// What an offset leads to.
    fn follow(&self, from: usize) -> Option<Self> {
        let at = self.at.checked_add(from)?;
        let offset = usize::try_from(u32::from_le_bytes(self.array(at)?)).ok()?;
        Some(Table { at: at.checked_add(offset)?, ..*self })
    }

    /// Where a field is, from the table on; none for a default.
    fn field(&self, index: usize) -> Option<usize> {
        let back = i64::from(i32::from_le_bytes(self.array(self.at)?));
        let places = usize::try_from(i64::try_from(self.at).ok()?.checked_sub(back)?).ok()?;
        let length = usize::from(u16::from_le_bytes(self.array(places)?));
        let place = 4 + 2 * index;
        if place + 2 > length {
            return None;
        }
        let offset = u16::from_le_bytes(self.array(places.checked_add(place)?)?);
        (offset != 0).then_some(usize::from(offset))
    }

    fn byte(&self, index: usize) -> Option<u8> {
        self.bytes.get(self.at.checked_add(self.field(index)?)?).copied()
    }

    fn short(&self, index: usize) -> Option<i16> {
        Some(i16::from_le_bytes(self.array(self.at.checked_add(self.field(index)?)?)?))
    }

    fn table(&self, index: usize) -> Option<Self> {
        self.follow(self.field(index)?)
    }

    /// The entries of a vector, and their number.
    fn vector(&self, index: usize) -> Option<(Self, usize)> {
        let vector = self.table(index)?;
        let count = usize::try_from(u32::from_le_bytes(self.array(vector.at)?)).ok()?;
        Some((Table { at: vector.at.checked_add(4)?, ..vector }, count))
    }

    fn text(&self, index: usize) -> Option<String> {
        let (text, length) = self.vector(index)?;
        let bytes = self.bytes.get(text.at..text.at.checked_add(length)?)?;
        Some(String::from_utf8_lossy(bytes).into_owned())
    }
}

/// The bytes of a text in base64 (RFC 4648, section 4).
fn decode(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0_u32, 0);
    for byte in text.trim_end_matches('=').bytes() {
        let digit = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        (bits, count) = ((bits << 6) | u32::from(digit), count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        for (text, bytes) in
            [("", &b""[..]), ("Zg==", b"f"), ("Zm8=", b"fo"), ("Zm9vYmE/", b"fooba?")]
        {
            assert_eq!(decode(text).unwrap(), bytes, "{text}");
        }
        assert_eq!(decode("Z!"), None);
    }

    #[test]
    fn damaged_schemas_have_no_durations() {
        for bytes in [&[][..], &[0xff; 64], &[0; 64], &[4; 64]] {
            assert_eq!(of_message(bytes), None);
        }
    }
}
