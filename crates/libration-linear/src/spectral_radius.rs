//! The spectral radius of a matrix.

use crate::Matrix;

/// The logarithm of the spectral radius: the growth of the norm of higher and higher powers (I. Gelfand, 1941), each the square of
/// the one before.
///
/// After 50 squares the difference between norm and radius is divided by 2⁵⁰. Where several of the largest eigenvalues meet,
/// rounding parts them, and three digits may be all that are right.
pub fn log_spectral_radius(matrix: &Matrix) -> f64 {
    let mut power = matrix.clone();
    let (mut logarithm, mut share) = (0.0, 1.0);
    for _ in 0..50 {
        // Squares of it could overflow.
        let norm = power.largest();
        if norm == 0.0 {
            return f64::NEG_INFINITY;
        }
        logarithm += share * norm.ln();
        share /= 2.0;
        power.normalise(norm);
        power = &power * &power;
    }
    logarithm
}

/// Whether the spectral radius is below 1, which is known sooner than its value: a power of norm below 1 says yes, and one whose
/// eigenvalues add up to more than their number says no.
pub fn is_schur_stable(matrix: &Matrix) -> bool {
    let (mut power, mut logarithm) = (matrix.clone(), 0.0);
    for _ in 0..50 {
        let norm = power.row_sum_norm();
        if norm == 0.0 || norm.ln() + logarithm < 0.0 {
            return true;
        }
        if norm.is_nan() || power.trace().abs().ln() + logarithm > (power.rows() as f64).ln() {
            return false;
        }
        power.normalise(norm);
        logarithm = 2.0 * (logarithm + norm.ln());
        power = &power * &power;
    }
    // Within a part of 10⁻¹⁵ of the edge.
    log_spectral_radius(matrix) < 0.0
}
