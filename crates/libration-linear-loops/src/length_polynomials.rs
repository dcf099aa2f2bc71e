//! Functions of the length of a period as polynomials.
//!
//! It uses rows alone: the tests of `tests/linear_loops` compile it with them, in place of the whole crate once more.

use core::ops::Range;

use libration_core::Elementary;

use super::row::{LANES, Row};

/// Functions of a length, each a sum of Chebyshev's polynomials on an interval.
#[derive(Clone, Debug, Default)]
pub(super) struct LengthPolynomials {
    ends: Vec<usize>,
    coefficients: Vec<f64>,
}

/// Most nodes of the interpolation.
const MOST_NODES: usize = 256;

/// The share of the largest value of a function up to which its coefficients count.
const NEGLIGIBLE: f64 = 1e-15;

/// The error of a matrix exponential, as a share of its largest entry.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl LengthPolynomials {
    /// The functions with these coefficients.
    pub(super) fn new<'a>(functions: impl IntoIterator<Item = &'a [f64]>) -> Self {
        let mut all = LengthPolynomials::default();
        for coefficients in functions {
            all.coefficients.extend_from_slice(coefficients);
            all.ends.push(all.coefficients.len());
        }
        all
    }

    /// The number of functions.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The number of coefficients.
    pub(super) fn work(&self) -> usize {
        self.coefficients.len()
    }

    /// The most coefficients of a function.
    pub(super) fn order(&self) -> usize {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| end - start).max().unwrap_or(0)
    }

    /// All functions at the lengths of which `basis` has Chebyshev's polynomials.
    #[inline(always)]
    pub(super) fn evaluate(&self, basis: &[Row], values: &mut [Row]) {
        let mut start = 0;
        for (value, &end) in values.iter_mut().zip(&self.ends) {
            let mut sum = [0.0; LANES];
            for (factor, polynomial) in self.coefficients[start..end].iter().zip(basis) {
                for l in 0..LANES {
                    sum[l] += factor * polynomial[l];
                }
            }
            *value = sum;
            start = end;
        }
    }
}

/// Chebyshev's polynomials at `s` between −1 and 1.
#[inline(always)]
pub(super) fn chebyshev(s: &Row, basis: &mut [Row]) {
    for q in 0..basis.len() {
        let mut next = [1.0; LANES];
        for l in 0..LANES {
            next[l] = match q {
                0 => 1.0,
                1 => s[l],
                _ => 2.0 * s[l] * basis[q - 1][l] - basis[q - 2][l],
            };
        }
        basis[q] = next;
    }
}

/// The coefficients of many functions of a length from `low` to `high`, interpolated at Chebyshev's nodes; none if 256 nodes are too few.
///
/// A coefficient counts if it is above 10⁻¹⁵ of the largest value of its function, or above sixteen roundings of the largest value in
/// its group, as a matrix exponential has. The coefficients of such entire functions fall faster than any power, so that the error is about
/// the first one that does not count (L. N. Trefethen, *Approximation Theory and Approximation Practice*, 2013, chapter 8).
pub(super) fn interpolated(
    functions: &dyn Fn(f64) -> Vec<f64>,
    groups: &[Range<usize>],
    [low, high]: [f64; 2],
) -> Option<Vec<Vec<f64>>> {
    let mut nodes = 16;
    while nodes <= MOST_NODES {
        let angle = |k: usize| core::f64::consts::PI * (k as f64 + 0.5) / nodes as f64;
        let at = |k| 0.5 * (low + high) + 0.5 * (high - low) * Elementary::cos(angle(k));
        let values: Vec<Vec<f64>> = (0..nodes).map(|k| functions(at(k))).collect();
        let mut all = Vec::new();
        let mut settled = true;
        for group in groups {
            let size = |i: usize| values.iter().map(|row| row[i].abs()).fold(0.0, f64::max);
            let largest = group.clone().map(size).fold(0.0, f64::max);
            for i in group.clone() {
                let coefficient = |q: usize| {
                    let share = if q == 0 { 1.0 } else { 2.0 } / nodes as f64;
                    let cosine = |k| Elementary::cos(q as f64 * angle(k));
                    share * (0..nodes).map(|k| values[k][i] * cosine(k)).sum::<f64>()
                };
                let mut coefficients: Vec<f64> = (0..nodes).map(coefficient).collect();
                let least = NEGLIGIBLE * size(i) + ROUNDING * largest;
                let order = coefficients.iter().rposition(|x| x.abs() > least);
                let order = order.map_or(0, |last| last + 1);
                // With room for those between the nodes.
                settled &= 4 * order <= 3 * nodes;
                coefficients.truncate(order);
                all.push(coefficients);
            }
        }
        if settled {
            return Some(all);
        }
        nodes *= 2;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolated_functions_are_right_between_the_nodes() {
        // A mode that decays by e⁻⁴⁰, an oscillation of 30 rad, a cube, a constant, and zero, on [0, 2].
        let functions =
            |h: f64| vec![(-20.0 * h).exp(), (15.0 * h).sin(), h.powi(3) / 3.0, 7.0, 0.0];
        let found = interpolated(&functions, &[0..2, 2..3, 3..5], [0.0, 2.0]).unwrap();
        let orders: Vec<usize> = found.iter().map(Vec::len).collect();
        assert_eq!(orders[2..], [4, 1, 0]);
        let polynomials = LengthPolynomials::new(found.iter().map(Vec::as_slice));
        assert_eq!(polynomials.order(), orders[0].max(orders[1]));
        let mut basis = vec![[0.0; LANES]; polynomials.order()];
        let mut values = vec![[0.0; LANES]; 5];
        for first in (0..1000).step_by(LANES) {
            let h: Row = core::array::from_fn(|l| 2.0 * (first + l) as f64 / 1007.0);
            chebyshev(&h.map(|h| h - 1.0), &mut basis);
            polynomials.evaluate(&basis, &mut values);
            for l in 0..LANES {
                for (i, wanted) in functions(h[l]).into_iter().enumerate() {
                    // Some fifty coefficients, each with a rounding.
                    let error = (values[i][l] - wanted).abs();
                    assert!(error < 50.0 * f64::EPSILON * wanted.abs().max(1.0), "{i} {error}");
                }
            }
        }
        let fast = |h: f64| vec![(1e4 * h).sin(), 1.0];
        assert_eq!(interpolated(&fast, &[0..1, 1..2], [0.0, 2.0]), None);
    }
}
