//! Matrices without the noise of differences.
//!
//! It uses nothing of the crate: the tests of `tests/probe` compile it alone, in place of the whole crate once more.

use libration::linear::Matrix;

/// Largest size of an entry beside the largest of all that is taken for rounding of differences.
const ROUNDING: f64 = 1e-11;

/// The matrix without the entries that are no larger than their errors: a reader would take them for terms of the equations.
pub(crate) fn without_noise(matrix: &Matrix, errors: &Matrix) -> Matrix {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let entries = || (0..rows).flat_map(|i| matrix.row(i).iter());
    let largest = entries().fold(0.0_f64, |most, x| most.max(x.abs()));
    Matrix::from_fn(rows, columns, |i, j| match matrix[(i, j)] {
        x if x.abs() <= errors[(i, j)].max(ROUNDING * largest) => 0.0,
        x => x,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_within_their_errors_are_no_terms_and_all_others_keep_their_bits() {
        let a = Matrix::from_fn(2, 2, |i, j| [[1.5e-12, 1.0], [-9.81, 1e-3]][i][j]);
        let errors = Matrix::from_fn(2, 2, |i, j| [[1e-13, 1e-12], [1e-12, 2e-3]][i][j]);
        let found = without_noise(&a, &errors);
        // The first is rounding beside 9.81, the last within its error.
        assert_eq!(found, Matrix::from_fn(2, 2, |i, j| [[0.0, 1.0], [-9.81, 0.0]][i][j]));
        assert_eq!(without_noise(&a, &errors.scaled(0.0))[(1, 1)], 1e-3);
    }
}
