//! A reader of numbers from bytes.

use bytemuck::Pod;

use super::CheckpointError;

/// The bytes that are left.
pub(crate) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// A reader of a state of exactly `wanted` bytes.
    pub(crate) fn new(state: &'a [u8], wanted: usize) -> Result<Self, CheckpointError> {
        let found = state.len();
        if found == wanted {
            Ok(Reader(state))
        } else {
            Err(CheckpointError::Length { found, wanted })
        }
    }

    /// Fills these numbers; leaves them unchanged if too few bytes are left.
    pub(crate) fn fill<X: Pod>(&mut self, to: &mut [X]) {
        let to: &mut [u8] = bytemuck::cast_slice_mut(to);
        if let Some((head, tail)) = self.0.split_at_checked(to.len()) {
            to.copy_from_slice(head);
            self.0 = tail;
        }
    }

    /// The next number.
    pub(crate) fn next<X: Pod>(&mut self) -> X {
        let mut one = [X::zeroed()];
        self.fill(&mut one);
        one[0]
    }
}
