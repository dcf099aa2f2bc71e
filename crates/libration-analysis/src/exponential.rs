//! The exponential of a matrix, in 1024 bits.

use libration_core::Scalar;
use libration_core::number::Wide;

/// A square matrix, row by row.
pub(super) type Matrix = Vec<Vec<Wide>>;

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let n = a.len();
    let entry = |i: usize, j: usize| (0..n).fold(Wide::ZERO, |sum, k| sum + a[i][k] * b[k][j]);
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

fn mapped(a: &Matrix, f: impl Fn(Wide) -> Wide) -> Matrix {
    a.iter().map(|row| row.iter().map(|&x| f(x)).collect()).collect()
}

/// `exp(a·t)`: Taylor's series of a small part of `t`, squared as often as it takes.
pub(super) fn exponential(a: &Matrix, t: Wide) -> Matrix {
    // With a part below 2⁻³² the terms fall by 32 bits each: 40 of them reach below 1024 bits.
    const TERMS: i32 = 40;
    const SMALL: i64 = -32;
    let size = a.iter().flatten().fold(Wide::ZERO, |sum, &x| sum + (x * t).abs());
    let above = size.exponent().map_or(SMALL, |exponent| exponent + 1);
    let halvings = (above - SMALL).max(0);
    let small = mapped(a, |x| (x * t).scaled(-halvings));
    let unit = |i: usize, j: usize| if i == j { Wide::one() } else { Wide::ZERO };
    let n = a.len();
    let mut sum: Matrix = (0..n).map(|i| (0..n).map(|j| unit(i, j)).collect()).collect();
    let mut term = sum.clone();
    for k in 1..=TERMS {
        term = mapped(&product(&term, &small), |x| x.ratio(1, k));
        for (row, more) in sum.iter_mut().zip(&term) {
            row.iter_mut().zip(more).for_each(|(x, &more)| *x = *x + more);
        }
    }
    (0..halvings).fold(sum, |power, _| product(&power, &power))
}
