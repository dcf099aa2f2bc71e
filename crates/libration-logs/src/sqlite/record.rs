//! Records of a database.

/// A value of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Value<'a> {
    Null,
    Integer(i64),
    Float(f64),
    Blob(&'a [u8]),
    Text(&'a [u8]),
}

impl Value<'_> {
    /// The integer.
    pub(crate) fn integer(self) -> Option<i64> {
        match self {
            Value::Integer(value) => Some(value),
            _ => None,
        }
    }

    /// The text.
    pub(crate) fn text(self) -> Option<String> {
        match self {
            Value::Text(bytes) => Some(String::from_utf8_lossy(bytes).into_owned()),
            _ => None,
        }
    }
}

/// A record: the types of its values, and the values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record<'a> {
    types: &'a [u8],
    body: &'a [u8],
}

impl<'a> Record<'a> {
    /// The record in these bytes; none if its types end early.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        let (length, rest) = varint(bytes)?;
        let end = usize::try_from(length).ok()?;
        let from = bytes.len() - rest.len();
        Some(Record { types: bytes.get(from..end)?, body: bytes.get(end..)? })
    }

    /// The value of a column; none if the record has fewer, or is damaged.
    pub(crate) fn value(&self, column: usize) -> Option<Value<'a>> {
        let (mut types, mut body) = (self.types, self.body);
        for _ in 0..column {
            let (kind, rest) = varint(types)?;
            body = body.split_at_checked(size(kind)?)?.1;
            types = rest;
        }
        let (kind, _) = varint(types)?;
        let bytes = body.split_at_checked(size(kind)?)?.0;
        Some(match kind {
            0 => Value::Null,
            1..=6 => Value::Integer(integer(bytes)),
            7 => Value::Float(f64::from_bits(integer(bytes).cast_unsigned())),
            8 | 9 => Value::Integer(kind - 8),
            kind if kind % 2 == 0 => Value::Blob(bytes),
            _ => Value::Text(bytes),
        })
    }
}

/// The number of bytes of a type.
fn size(kind: i64) -> Option<usize> {
    match kind {
        0 | 8 | 9 => Some(0),
        1..=4 => usize::try_from(kind).ok(),
        5 => Some(6),
        6 | 7 => Some(8),
        // 10 and 11 are reserved.
        12.. => usize::try_from((kind - 12) / 2).ok(),
        _ => None,
    }
}

/// A big-endian integer with a sign.
fn integer(bytes: &[u8]) -> i64 {
    let sign = if bytes.first().is_some_and(|&byte| byte > 0x7f) { -1 } else { 0 };
    bytes.iter().fold(sign, |value, &byte| (value << 8) | i64::from(byte))
}

/// A number of one to nine bytes, and the bytes behind it.
pub(super) fn varint(bytes: &[u8]) -> Option<(i64, &[u8])> {
    let mut value = 0_u64;
    for (i, &byte) in bytes.iter().enumerate().take(9) {
        if i == 8 {
            return Some((((value << 8) | u64::from(byte)).cast_signed(), &bytes[9..]));
        }
        value = (value << 7) | u64::from(byte & 0x7f);
        if byte < 0x80 {
            return Some((value.cast_signed(), &bytes[i + 1..]));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_types_of_the_format() {
        let types = [1, 5, 7, 0, 9, 12 + 2 * 2, 13 + 2 * 3];
        let mut bytes = vec![types.len() as u8 + 1];
        bytes.extend(types);
        bytes.push(0xfe);
        bytes.extend([0x7f, 0, 0, 0, 0, 1]);
        bytes.extend(1.5_f64.to_be_bytes());
        bytes.extend([1, 2, b'a', b'b', b'c']);
        let record = Record::new(&bytes).unwrap();
        let wanted = [
            Value::Integer(-2),
            Value::Integer(0x7f00_0000_0001),
            Value::Float(1.5),
            Value::Null,
            Value::Integer(1),
            Value::Blob(&[1, 2]),
            Value::Text(b"abc"),
        ];
        for (i, wanted) in wanted.into_iter().enumerate() {
            assert_eq!(record.value(i), Some(wanted));
        }
        assert_eq!(record.value(7), None);
        let short = &bytes[..bytes.len() - 1];
        assert_eq!(Record::new(short).unwrap().value(6), None);
    }

    #[test]
    fn a_number_has_one_to_nine_bytes() {
        for (bytes, value) in [
            (&[0x7f][..], 127),
            (&[0x81, 0], 128),
            (&[0xff; 9], -1),
            (&[0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 5], 5),
        ] {
            assert_eq!(varint(bytes), Some((value, &[][..])));
            assert_eq!(varint(&bytes[..bytes.len() - 1]), None);
        }
    }
}
