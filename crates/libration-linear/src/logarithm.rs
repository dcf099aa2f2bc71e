//! The logarithm of a matrix.

use crate::hessenberg::balance;
use crate::{Matrix, exponential, solve_matrix};

/// Most square roots. Each halves the logarithm, and doubles its rounding.
const MOST_ROOTS: usize = 40;
/// Distance from the identity at which the series converges in [`TERMS`] terms to rounding: `0.15^(2·10 + 1)`.
const NEAR: f64 = 0.25;
const TERMS: i32 = 10;
/// Most iterations of a square root, which converges quadratically.
const MOST_ITERATIONS: usize = 60;
/// Largest relative error with which the exponential of the result must be the matrix.
const TOLERANCE: f64 = 1e-7;

/// The principal logarithm of a square matrix; none if an eigenvalue is zero, on the negative real axis or next to it.
///
/// Square roots by the product form of the iteration of E. Denman and A. Beavers until the matrix is near the identity, then the series
/// of the inverse hyperbolic tangent (N. Higham, *Functions of Matrices*, 2008, sections 6.3 and 11.5).
/// In coordinates of powers of two that balance its rows and columns, so that units do not count.
pub fn logarithm(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.rows();
    let mut balanced = matrix.clone();
    let scales = balance(&mut balanced);
    let found = logarithm_of_balanced(&balanced)?;
    Some(Matrix::from_fn(n, n, |i, j| found[(i, j)] * scales[i] / scales[j]))
}

fn logarithm_of_balanced(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.rows();
    let identity = Matrix::identity(n);
    let mut root = matrix.clone();
    let mut roots = 0;
    let off = |root: &Matrix| root.plus(&identity.scaled(-1.0)).row_sum_norm();
    while off(&root) > NEAR {
        if roots == MOST_ROOTS {
            return None;
        }
        root = square_root(&root)?;
        roots += 1;
    }
    // log X = 2 artanh W with W = (X + 1)⁻¹ (X − 1).
    let w = solve_matrix(&root.plus(&identity), &root.plus(&identity.scaled(-1.0)))?;
    let square = &w * &w;
    let mut power = w.clone();
    let mut sum = w;
    for k in 1..=TERMS {
        power = &power * &square;
        sum.add_scaled(f64::from(2 * k + 1).recip(), &power);
    }
    let found = sum.scaled(2.0_f64.powi(roots as i32 + 1));
    let error = exponential(&found).plus(&matrix.scaled(-1.0)).row_sum_norm();
    (found.is_finite() && error <= TOLERANCE * matrix.row_sum_norm()).then_some(found)
}

fn square_root(matrix: &Matrix) -> Option<Matrix> {
    let identity = Matrix::identity(matrix.rows());
    let (mut root, mut inverse_root) = (matrix.clone(), identity.clone());
    let mut before = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let (a, b) = (solve_matrix(&inverse_root, &identity)?, solve_matrix(&root, &identity)?);
        let next = root.plus(&a).scaled(0.5);
        inverse_root = inverse_root.plus(&b).scaled(0.5);
        let change = next.plus(&root.scaled(-1.0)).row_sum_norm() / next.row_sum_norm();
        root = next;
        if !root.is_finite() {
            return None;
        }
        // Quadratic convergence ends where rounding does.
        if change < 1e-15 || (change < 1e-9 && change >= before) {
            return Some(root);
        }
        before = change;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[f64]]) -> Matrix {
        Matrix::from_rows(rows).unwrap()
    }

    #[test]
    fn the_logarithm_undoes_the_exponential_also_of_a_free_mass() {
        for rates in [
            matrix(&[&[0.0, 1.0], &[0.0, 0.0]]),
            matrix(&[&[0.0, 1.0], &[-7.0, -0.2]]),
            matrix(&[&[-8.0, 2.0, 0.1], &[0.0, -0.5, 1.0], &[0.3, 0.0, 0.4]]),
        ] {
            let found = logarithm(&exponential(&rates)).unwrap();
            let error = found.plus(&rates.scaled(-1.0)).row_sum_norm();
            // Roundings of a matrix beside its least eigenvalue, e⁻⁸, and of some square roots.
            assert!(error < 100.0 * f64::EPSILON * 8.0_f64.exp(), "{error:e} {found:?}");
        }
    }

    #[test]
    fn a_matrix_with_a_negative_or_a_zero_eigenvalue_has_none() {
        assert_eq!(logarithm(&Matrix::diagonal(&[-1.0, 2.0])), None);
        assert_eq!(logarithm(&Matrix::diagonal(&[0.0, 2.0])), None);
        assert_eq!(logarithm(&matrix(&[&[-0.5, 1.0], &[0.0, -0.5]])), None);
    }
}
