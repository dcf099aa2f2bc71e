//! How many bytes a compressed file may unpack to: a few bytes can be many zeros, and many empty messages.

use std::cell::Cell;
use std::io::{self, ErrorKind, Read};

use crate::error::LogError;
use crate::input::Input;

/// A recording unpacks to at most this multiple of its file: numbers that a sensor measured repeat less.
const TIMES: u64 = 200;
/// Bytes that any file may unpack to.
const LEAST: u64 = 64 << 20;

/// Most bytes that a compressed file of `len` bytes may unpack to.
pub(crate) fn most_unpacked(len: u64) -> u64 {
    len.saturating_mul(TIMES).max(LEAST)
}

/// What is left of the bytes that a file may unpack to.
pub(crate) struct UnpackBudget {
    most: u64,
    left: Cell<u64>,
    is_spent: Cell<bool>,
}

impl UnpackBudget {
    /// The budget of an input.
    pub(crate) fn of(input: &Input) -> io::Result<Self> {
        let most = most_unpacked(input.len()?);
        Ok(UnpackBudget { most, left: Cell::new(most), is_spent: Cell::new(false) })
    }

    /// A reader of unpacked bytes, which fails where the budget ends.
    pub(crate) fn reader<R: Read>(&self, unpacked: R) -> Budgeted<'_, R> {
        Budgeted { budget: self, unpacked }
    }

    /// Fails if a reader came to the end of the budget.
    pub(crate) fn check(&self) -> Result<(), LogError> {
        match self.is_spent.get() {
            true => Err(LogError::Unpacked { most: self.most, times: TIMES }),
            false => Ok(()),
        }
    }
}

/// A reader within a budget.
pub(crate) struct Budgeted<'a, R> {
    budget: &'a UnpackBudget,
    unpacked: R,
}

impl<R: Read> Read for Budgeted<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.unpacked.read(buffer)?;
        match self.budget.left.get().checked_sub(count as u64) {
            Some(left) => {
                self.budget.left.set(left);
                Ok(count)
            }
            None => {
                self.budget.is_spent.set(true);
                Err(ErrorKind::FileTooLarge.into())
            }
        }
    }
}
