//! The memory of loops between steps.

use core::mem::take;

use bytemuck::Pod;

use crate::ensemble::{Buffer, EnsembleError, GRAIN, InsufficientMemory, Pages};

/// The memories of all trajectories: one piece per [`GRAIN`] neighbours, row after row.
#[derive(Debug)]
pub(super) struct Memories<T> {
    numbers: Buffer<T>,
    rows: usize,
}

impl<T: Pod> Memories<T> {
    /// Zeros for `len` trajectories.
    ///
    /// # Errors
    /// If there is not so much memory.
    pub(super) fn new(len: usize, rows: usize) -> Result<Self, EnsembleError> {
        let all = len.div_ceil(GRAIN).checked_mul(GRAIN * rows);
        let needed = len as u128 * rows as u128 * size_of::<T>() as u128;
        let all = all.ok_or(InsufficientMemory { needed, available: None })?;
        Ok(Memories { numbers: Buffer::new(all, Pages::Huge)?, rows })
    }

    /// All of them.
    pub(super) fn rows(&mut self) -> Rows<'_, T> {
        Rows { numbers: &mut self.numbers, rows: self.rows }
    }

    /// All numbers, in the order of the memory.
    pub(super) fn numbers(&self) -> &[T] {
        &self.numbers
    }

    /// All numbers, in the order of the memory, for writing.
    pub(super) fn numbers_mut(&mut self) -> &mut [T] {
        &mut self.numbers
    }
}

/// The memories of neighbouring trajectories, from a multiple of [`GRAIN`] on.
#[derive(Debug)]
pub(super) struct Rows<'a, T> {
    numbers: &'a mut [T],
    rows: usize,
}

impl<'a, T: Copy> Rows<'a, T> {
    /// Takes off the first `count` trajectories, a multiple of [`GRAIN`], or all if there are fewer.
    pub(super) fn split_off(&mut self, count: usize) -> Rows<'a, T> {
        let numbers = take(&mut self.numbers);
        let (head, tail) = numbers.split_at_mut((count * self.rows).min(numbers.len()));
        self.numbers = tail;
        Rows { numbers: head, rows: self.rows }
    }

    /// The memories of `W` trajectories, a divisor or a multiple of [`GRAIN`], from number `first` on.
    #[inline(always)]
    pub(super) fn of<const W: usize>(&mut self, first: usize) -> Block<'_, T, W> {
        let size = GRAIN * self.rows;
        let begin = first / GRAIN * size;
        let end = (begin + W.div_ceil(GRAIN) * size).min(self.numbers.len());
        let pieces = &mut self.numbers[begin..end];
        Block { pieces, rows: self.rows, lane: first % GRAIN }
    }
}

/// The memories of `W` neighbouring trajectories.
#[derive(Debug)]
pub(super) struct Block<'a, T, const W: usize> {
    pieces: &'a mut [T],
    rows: usize,
    /// In the piece where they begin; they end in it, or begin with it.
    lane: usize,
}

impl<T: Copy, const W: usize> Block<'_, T, W> {
    /// A row; lanes beyond the last piece are `fill`.
    #[inline(always)]
    pub(super) fn get(&self, row: usize, fill: T) -> [T; W] {
        let mut lanes = [fill; W];
        let size = if W < GRAIN { W } else { GRAIN };
        for (i, part) in lanes.chunks_exact_mut(size).enumerate() {
            let begin = (i * self.rows + row) * GRAIN + self.lane;
            if let Some(values) = self.pieces.get(begin..begin + size) {
                part.copy_from_slice(values);
            }
        }
        lanes
    }

    /// The number in lane `l` of a row, which is within the pieces.
    #[inline(always)]
    pub(super) fn lane(&self, row: usize, l: usize) -> Option<T> {
        let (piece, lane) = if W < GRAIN { (0, self.lane + l) } else { (l / GRAIN, l % GRAIN) };
        self.pieces.get((piece * self.rows + row) * GRAIN + lane).copied()
    }

    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, lanes: &[T; W]) {
        let size = if W < GRAIN { W } else { GRAIN };
        for (i, part) in lanes.chunks_exact(size).enumerate() {
            let begin = (i * self.rows + row) * GRAIN + self.lane;
            if let Some(values) = self.pieces.get_mut(begin..begin + size) {
                values.copy_from_slice(part);
            }
        }
    }
}
