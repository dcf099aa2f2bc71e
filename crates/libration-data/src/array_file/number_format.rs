//! Numbers as a file stores them.

/// How a number is coded.
#[derive(Clone, Copy, Debug)]
pub(super) enum NumberKind {
    Float,
    Signed,
    Unsigned,
}

/// The code, the size in bytes, and the order of the bytes of a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct NumberFormat {
    kind: NumberKind,
    size: usize,
    big_endian: bool,
}

impl NumberFormat {
    /// A format, if numbers of this kind have such a size: 4 or 8 bytes for floats, and 1 or 2 also for integers.
    pub(super) fn new(kind: NumberKind, size: usize, big_endian: bool) -> Option<Self> {
        let exists = match kind {
            NumberKind::Float => matches!(size, 4 | 8),
            NumberKind::Signed | NumberKind::Unsigned => matches!(size, 1 | 2 | 4 | 8),
        };
        exists.then_some(Self { kind, size, big_endian })
    }

    /// The numbers of an array of this shape.
    ///
    /// # Errors
    /// If the number of bytes does not fit, or an integer is not a `f64`.
    pub(super) fn decode(self, bytes: &[u8], shape: &[usize]) -> Result<Vec<f64>, String> {
        // A checked product: a shape is not trusted before the bytes confirm it.
        let expected = shape.iter().try_fold(self.size, |product, &n| product.checked_mul(n));
        if expected != Some(bytes.len()) {
            let expected = expected.map_or("more".to_owned(), |count| count.to_string());
            return Err(format!(
                "it has {} bytes of numbers; expected {expected} for the shape {shape:?}",
                bytes.len()
            ));
        }
        bytes.chunks_exact(self.size).map(|one| self.number(one)).collect()
    }

    /// The integers of an array of this shape, all digits of them; none if they are floats or do not fit.
    pub(super) fn decode_integers(self, bytes: &[u8], shape: &[usize]) -> Option<Vec<i64>> {
        let expected = shape.iter().try_fold(self.size, |product, &n| product.checked_mul(n));
        let is_integer = matches!(self.kind, NumberKind::Signed | NumberKind::Unsigned);
        if !is_integer || expected != Some(bytes.len()) {
            return None;
        }
        bytes.chunks_exact(self.size).map(|one| i64::try_from(self.integer(one)).ok()).collect()
    }

    fn number(self, bytes: &[u8]) -> Result<f64, String> {
        match (self.kind, self.size) {
            (NumberKind::Float, 4) => Ok(f64::from(f32::from_bits(self.bits(bytes) as u32))),
            (NumberKind::Float, _) => Ok(f64::from_bits(self.bits(bytes))),
            _ => exact(self.integer(bytes)),
        }
    }

    fn integer(self, bytes: &[u8]) -> i128 {
        let unused = 64 - 8 * self.size as u32;
        let bits = self.bits(bytes);
        match self.kind {
            NumberKind::Signed => i128::from((bits << unused) as i64 >> unused),
            _ => i128::from(bits),
        }
    }

    fn bits(self, bytes: &[u8]) -> u64 {
        let mut ordered = [0; 8];
        ordered[..self.size].copy_from_slice(bytes);
        if self.big_endian {
            ordered[..self.size].reverse();
        }
        u64::from_le_bytes(ordered)
    }
}

/// An integer as a `f64`, if none is lost.
fn exact(integer: i128) -> Result<f64, String> {
    if integer.unsigned_abs() > 1 << f64::MANTISSA_DIGITS {
        return Err(format!("it has the integer {integer}; expected at most 2^53"));
    }
    Ok(integer as f64)
}
