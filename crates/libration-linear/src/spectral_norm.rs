//! The spectral norm of a matrix.

use crate::{Matrix, eigenvalues};

/// The spectral norm, the largest singular value, rounded up; infinite if an entry is infinite or NaN.
pub fn spectral_norm(matrix: &Matrix) -> f64 {
    let size = matrix.largest();
    if size == 0.0 {
        return 0.0;
    }
    let scaled = matrix.scaled(size.recip());
    let square = &scaled.transposed() * &scaled;
    let Some(values) = eigenvalues(&square) else { return f64::INFINITY };
    let largest = values.iter().map(|value| value.re).fold(0.0, f64::max);
    // Eigenvalues of a symmetric matrix err by some roundings of its norm, and so do its entries.
    let rounding = 1.0 + 16.0 * f64::EPSILON * (matrix.rows() + matrix.columns()) as f64;
    size * largest.sqrt() * rounding
}

/// Whether the spectral norm is below `bound`: whether `bound² − MᵀM` has a Cholesky factor, with pivots that rounding cannot
/// make positive.
pub(crate) fn is_norm_below(matrix: &Matrix, bound: f64) -> bool {
    let n = matrix.columns();
    let square = &matrix.transposed() * matrix;
    let total = square.trace();
    if total < bound * bound {
        // The norm of all entries is not less than the spectral norm.
        return true;
    }
    let rounding = 8.0 * (n + matrix.rows()) as f64 * f64::EPSILON * (total + bound * bound);
    let mut rest = square.scaled(-1.0);
    for i in 0..n {
        rest[(i, i)] += bound * bound - rounding;
    }
    for k in 0..n {
        let pivot = rest[(k, k)];
        if pivot.is_nan() || pivot <= rounding {
            return false;
        }
        for i in k + 1..n {
            let factor = rest[(i, k)] / pivot;
            if factor != 0.0 {
                rest.subtract_row(i, factor, k, k);
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_norm_of_a_matrix_of_known_singular_values_is_the_largest() {
        // A turn, singular values 3 and 1/2, and another turn.
        let turn = |angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            Matrix::from_rows(&[[cosine, -sine], [sine, cosine]]).unwrap()
        };
        let matrix = &(&turn(0.7) * &Matrix::diagonal(&[0.5, -3.0])) * &turn(1.9);
        let norm = spectral_norm(&matrix);
        // Roundings of numbers up to 9, and what is added for them.
        assert!((3.0..3.0 + 1e-13).contains(&norm), "{norm}");
        assert!(is_norm_below(&matrix, 3.0 + 1e-12) && !is_norm_below(&matrix, 3.0 - 1e-12));
        assert_eq!(spectral_norm(&Matrix::zeros(3, 3)), 0.0);
        assert_eq!(spectral_norm(&Matrix::diagonal(&[1.0, f64::NAN])), f64::INFINITY);
    }
}
