//! The states of many trajectories as structure of arrays.

use core::array::from_fn;
use core::mem::take;

use bytemuck::Pod;
use libration_core::array::rows;
use libration_core::{Scalar, State};

use super::assign::padded;
use super::{Buffer, EnsembleError, InsufficientMemory, Lanes, Pages};

/// Bytes by which each plane begins later than a multiple of a page would: planes that begin at
/// the same place in their pages fight for the same few lines of the caches.
const STAGGER: usize = 5 * 64;

/// A page, and the unit of allocation.
const PAGE: usize = 4096;

/// Arrays of equal length in one piece of memory, each aligned to a cache line: positions, then velocities.
#[derive(Debug)]
pub(super) struct Planes<T> {
    memory: Buffer<T>,
    /// Elements from the beginning of one plane to that of the next.
    stride: usize,
    len: usize,
}

impl<T: Pod> Planes<T> {
    /// Zeros in untouched memory: the system allocates a page when it is first written.
    ///
    /// # Errors
    /// If there is not so much memory.
    pub(super) fn new(count: usize, len: usize) -> Result<Self, EnsembleError> {
        let refused = || InsufficientMemory { needed: Self::bytes(count, len), available: None };
        let stride = Self::plane(len).ok_or_else(refused)? / size_of::<T>();
        let all = stride.checked_mul(count).ok_or_else(refused)?;
        let memory = Buffer::new(all, Pages::Huge)?;
        Ok(Planes { memory, stride, len })
    }

    /// Bytes in one plane with what follows it.
    fn plane(len: usize) -> Option<usize> {
        len.checked_mul(size_of::<T>())?.checked_next_multiple_of(PAGE)?.checked_add(STAGGER)
    }

    /// Bytes that `count` planes of `len` trajectories take, as if there were room for any number.
    pub(super) fn bytes(count: usize, len: usize) -> u128 {
        let plane = (len as u128 * size_of::<T>() as u128).next_multiple_of(PAGE as u128);
        (plane + STAGGER as u128) * count as u128
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Plane `i` of `q₀ … q_{D−1}, v₀ … v_{D−1}`.
    pub(super) fn plane_of(&self, i: usize) -> &[T] {
        &self.memory[i * self.stride..][..self.len]
    }

    /// All planes.
    pub(super) fn planes_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        let len = self.len;
        // Where nothing is stored, there is no chunk.
        self.memory.chunks_exact_mut(self.stride.max(1)).map(move |plane| &mut plane[..len])
    }

    /// All planes of `D` positions and velocities.
    pub(super) fn share<const D: usize>(&mut self) -> Share<'_, T, D> {
        let mut planes = self.planes_mut();
        // There are 2·D of them.
        let mut next = || planes.next().unwrap_or_default();
        let q = from_fn(|_| next());
        Share { first: 0, q, v: from_fn(|_| next()) }
    }

    /// Position and velocity `i` of so many degrees of freedom. Nothing is allocated, which would take longer than a step of few
    /// trajectories.
    #[cfg(not(test))]
    pub(super) fn coordinate(&mut self, i: usize, degrees: usize) -> Share<'_, T, 1> {
        let (stride, len) = (self.stride, self.len);
        let (positions, velocities) = self.memory.split_at_mut((degrees + i) * stride);
        Share { first: 0, q: [&mut positions[i * stride..][..len]], v: [&mut velocities[..len]] }
    }
}

/// Blocks of `W` neighbouring trajectories: their positions and their velocities.
type Blocks<'a, T, const D: usize, const W: usize> = ([&'a mut [[T; W]]; D], [&'a mut [[T; W]]; D]);

/// The states of neighbouring trajectories.
#[derive(Debug)]
pub(super) struct Share<'a, T, const D: usize> {
    /// Index of the first of them in the ensemble.
    pub(super) first: usize,
    pub(super) q: [&'a mut [T]; D],
    pub(super) v: [&'a mut [T]; D],
}

impl<'a, T: Copy, const D: usize> Share<'a, T, D> {
    /// The number of trajectories.
    pub(super) fn len(&self) -> usize {
        self.q.first().map_or(0, |plane| plane.len())
    }

    /// Takes off the first `count`, or all if there are fewer.
    pub(super) fn split_off(&mut self, count: usize) -> Share<'a, T, D> {
        let count = count.min(self.len());
        let mut cut = |plane: &mut &'a mut [T]| {
            let (head, tail) = take(plane).split_at_mut(count);
            *plane = tail;
            head
        };
        let q = self.q.each_mut().map(&mut cut);
        let v = self.v.each_mut().map(&mut cut);
        let first = self.first;
        self.first += count;
        Share { first, q, v }
    }

    /// Blocks of `W`, as many as are full: position `i` of block `b` at `.0[i][b]`.
    #[inline(always)]
    pub(super) fn full_blocks<const W: usize>(self) -> Blocks<'a, T, D, W> {
        let count = self.len() / W;
        let blocks = |plane: &'a mut [T]| &mut plane.as_chunks_mut::<W>().0[..count];
        (self.q.map(blocks), self.v.map(blocks))
    }

    /// All of them in arrays of a fixed size; lanes beyond the last trajectory repeat it.
    #[inline(always)]
    pub(super) fn load<const W: usize>(&self) -> ([[T; W]; D], [[T; W]; D])
    where
        T: Scalar,
    {
        (rows(|i| padded(self.q[i])), rows(|i| padded(self.v[i])))
    }

    /// Takes back what [`Share::load`] gave.
    #[inline(always)]
    pub(super) fn store<const W: usize>(&mut self, q: &[[T; W]; D], v: &[[T; W]; D]) {
        let count = self.len();
        for i in 0..D {
            self.q[i].copy_from_slice(&q[i][..count]);
            self.v[i].copy_from_slice(&v[i][..count]);
        }
    }

    /// The lanes that an observer receives.
    pub(super) fn lanes(&self, step: u64) -> Lanes<'_, T, D> {
        let (mut q, mut v): ([&[T]; D], [&[T]; D]) = ([&[]; D], [&[]; D]);
        for i in 0..D {
            (q[i], v[i]) = (&*self.q[i], &*self.v[i]);
        }
        Lanes { first: self.first, step, q, v }
    }

    /// Sets trajectory `n` of these.
    pub(super) fn set(&mut self, n: usize, state: State<T, D>) {
        for i in 0..D {
            self.q[i][n] = state.q[i];
            self.v[i][n] = state.v[i];
        }
    }
}
