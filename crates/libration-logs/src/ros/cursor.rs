//! Bytes of messages, without panics.

use super::Wire;

/// Reads numbers in the order of a message.
pub(super) struct Cursor<'a> {
    data: &'a [u8],
    at: usize,
    big_endian: bool,
    /// Numbers are aligned to their size, at most to this.
    alignment: usize,
}

impl<'a> Cursor<'a> {
    /// The bytes behind the encapsulation of CDR (OMG DDS-XTypes 1.3, table 60), or all bytes of a message of ROS 1.
    pub(super) fn new(data: &'a [u8], wire: Wire) -> Option<Self> {
        if wire == Wire::Packed {
            return Some(Cursor { data, at: 0, big_endian: false, alignment: 1 });
        }
        let (head, data) = data.split_at_checked(4)?;
        // Plain CDR of version 1, which all middleware of ROS 2 writes.
        if head[1] > 1 {
            return None;
        }
        Some(Cursor { data, at: 0, big_endian: head[1] == 0, alignment: 8 })
    }

    /// The number of bytes that are left.
    pub(super) fn left(&self) -> usize {
        self.data.len() - self.at
    }

    pub(super) fn skip(&mut self, count: usize) -> Option<()> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.data.len())?;
        self.at = end;
        Some(())
    }

    /// The bits of an aligned number of 1, 2, 4 or 8 bytes.
    pub(super) fn bits(&mut self, size: usize) -> Option<u64> {
        self.align(size)?;
        let bytes = self.data.get(self.at..self.at.checked_add(size)?)?;
        self.at += size;
        let join = |bits: u64, byte: &u8| (bits << 8) | u64::from(*byte);
        Some(match self.big_endian {
            true => bytes.iter().fold(0, join),
            false => bytes.iter().rev().fold(0, join),
        })
    }

    /// Goes to a multiple of the size of a number.
    pub(super) fn align(&mut self, size: usize) -> Option<()> {
        let size = size.clamp(1, self.alignment);
        self.skip(self.at.next_multiple_of(size) - self.at)
    }

    /// A length of 4 bytes.
    pub(super) fn length(&mut self) -> Option<usize> {
        usize::try_from(self.bits(4)?).ok()
    }
}
