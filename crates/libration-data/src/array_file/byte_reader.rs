//! Reading bytes one after the other.

/// The rest of a sequence of bytes. Every read checks that it is long enough.
#[derive(Clone, Copy)]
pub(super) struct ByteReader<'a> {
    rest: &'a [u8],
    big_endian: bool,
}

impl<'a> ByteReader<'a> {
    pub(super) fn little_endian(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, big_endian: false }
    }

    pub(super) fn new(bytes: &'a [u8], big_endian: bool) -> Self {
        Self { rest: bytes, big_endian }
    }

    pub(super) fn is_big_endian(&self) -> bool {
        self.big_endian
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The next `count` bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or_else(|| {
            format!("{} bytes are left; expected at least {count}", self.rest.len())
        })?;
        self.rest = rest;
        Ok(taken)
    }

    /// Skips `count` bytes, or all that are left.
    pub(super) fn skip_up_to(&mut self, count: usize) {
        self.rest = &self.rest[count.min(self.rest.len())..];
    }

    /// An unsigned number of two bytes.
    pub(super) fn u16(&mut self) -> Result<usize, String> {
        self.number(2)
    }

    /// An unsigned number of four bytes.
    pub(super) fn u32(&mut self) -> Result<usize, String> {
        self.number(4)
    }

    fn number(&mut self, bytes: usize) -> Result<usize, String> {
        let taken = self.take(bytes)?;
        let join = |sum: usize, &byte: &u8| sum << 8 | usize::from(byte);
        Ok(if self.big_endian {
            taken.iter().fold(0, join)
        } else {
            taken.iter().rev().fold(0, join)
        })
    }
}
