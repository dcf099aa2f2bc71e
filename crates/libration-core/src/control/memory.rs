//! Memory of clocks, delays and controllers per trajectory.

use core::fmt::Debug;

use crate::Scalar;
use crate::array::{each, rows};

/// Numbers that a clock, a delay or a controller keeps of every trajectory: part of the state of a loop.
///
/// An array of numbers, or a pair of such memories.
pub trait Memory<T: Copy>: Copy + Send + Sync {
    /// The number of values.
    const LEN: usize;

    /// The memories of `W` neighbouring trajectories, a row for each number.
    #[doc(hidden)]
    type Lanes<const W: usize>: Copy + Debug + Send + Sync;

    /// Loads the memory from its rows.
    #[doc(hidden)]
    fn load<const W: usize>(row: &impl Fn(usize) -> [T; W]) -> Self::Lanes<W>;

    /// Stores the memory to its rows.
    #[doc(hidden)]
    fn store<const W: usize>(lanes: &Self::Lanes<W>, write: &mut impl FnMut(usize, &[T; W]));

    /// The memory as a single lane.
    #[doc(hidden)]
    fn single_lane(self) -> Self::Lanes<1>;

    /// The memory of lane `l`.
    #[doc(hidden)]
    fn lane<const W: usize>(lanes: &Self::Lanes<W>, l: usize) -> Self;

    /// Sets the memory of lane `l`.
    #[doc(hidden)]
    fn set_lane<const W: usize>(lanes: &mut Self::Lanes<W>, l: usize, memory: Self);
}

impl<T: Scalar + Send + Sync, const N: usize> Memory<T> for [T; N] {
    const LEN: usize = N;
    type Lanes<const W: usize> = [[T; W]; N];

    #[inline(always)]
    fn load<const W: usize>(row: &impl Fn(usize) -> [T; W]) -> [[T; W]; N] {
        rows(row)
    }

    #[inline(always)]
    fn store<const W: usize>(lanes: &[[T; W]; N], write: &mut impl FnMut(usize, &[T; W])) {
        for (i, row) in lanes.iter().enumerate() {
            write(i, row);
        }
    }

    fn single_lane(self) -> [[T; 1]; N] {
        rows(|i| [self[i]])
    }

    #[inline(always)]
    fn lane<const W: usize>(lanes: &[[T; W]; N], l: usize) -> Self {
        each(|i| lanes[i][l])
    }

    #[inline(always)]
    fn set_lane<const W: usize>(lanes: &mut [[T; W]; N], l: usize, memory: Self) {
        for i in 0..N {
            lanes[i][l] = memory[i];
        }
    }
}

impl<T: Copy, A: Memory<T>, B: Memory<T>> Memory<T> for (A, B) {
    const LEN: usize = A::LEN + B::LEN;
    type Lanes<const W: usize> = (A::Lanes<W>, B::Lanes<W>);

    #[inline(always)]
    fn load<const W: usize>(row: &impl Fn(usize) -> [T; W]) -> Self::Lanes<W> {
        (A::load(row), B::load(&|i| row(A::LEN + i)))
    }

    #[inline(always)]
    fn store<const W: usize>(lanes: &Self::Lanes<W>, write: &mut impl FnMut(usize, &[T; W])) {
        A::store(&lanes.0, write);
        B::store(&lanes.1, &mut |i, row| write(A::LEN + i, row));
    }

    fn single_lane(self) -> Self::Lanes<1> {
        (self.0.single_lane(), self.1.single_lane())
    }

    #[inline(always)]
    fn lane<const W: usize>(lanes: &Self::Lanes<W>, l: usize) -> Self {
        (A::lane(&lanes.0, l), B::lane(&lanes.1, l))
    }

    #[inline(always)]
    fn set_lane<const W: usize>(lanes: &mut Self::Lanes<W>, l: usize, memory: Self) {
        A::set_lane(&mut lanes.0, l, memory.0);
        B::set_lane(&mut lanes.1, l, memory.1);
    }
}
