//! Loops over the elements of arrays.
//!
//! `core::array::from_fn` and `map` are half a dozen functions for every closure: where there are hundreds of kernels, a tenth of
//! all code consists of them, and a compiler may not inline them from one unit of code into another.

use crate::Scalar;

/// An array of the values of `f` at each index.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "an iterator would be such functions again")]
pub fn each<S: Scalar, const N: usize>(mut f: impl FnMut(usize) -> S) -> [S; N] {
    let mut all = [S::zero(); N];
    for i in 0..N {
        all[i] = f(i);
    }
    all
}

/// An array of the rows that `f` gives at each index.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "as above")]
pub fn rows<S: Scalar, const W: usize, const N: usize>(
    mut f: impl FnMut(usize) -> [S; W],
) -> [[S; W]; N] {
    let mut all = [[S::zero(); W]; N];
    for i in 0..N {
        all[i] = f(i);
    }
    all
}

/// An array of the values of `f` at each element.
#[inline(always)]
pub fn map<X: Copy, S: Scalar, const N: usize>(from: [X; N], mut f: impl FnMut(X) -> S) -> [S; N] {
    each(|i| f(from[i]))
}
