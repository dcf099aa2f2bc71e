//! Eigenvectors of real matrices.

use num_complex::Complex64;

use crate::{Matrix, solve};

/// The size of a state matrix; 1 of zero, which has a size in no unit.
pub(crate) fn size_of(a: &Matrix) -> f64 {
    if a.largest() == 0.0 { 1.0 } else { a.row_sum_norm() }
}

/// The right eigenvector of a simple eigenvalue, of largest entry 1; none if the matrix has an entry that is infinite or NaN.
///
/// By inverse iteration.
pub fn eigenvector(matrix: &Matrix, value: Complex64) -> Option<Vec<Complex64>> {
    let n = matrix.rows();
    let size = size_of(matrix);
    // Off the eigenvalue by a rounding, so that the equations have a solution.
    let near = value + Complex64::new(1.0, 1.0) * (size * 4.0 * f64::EPSILON);
    let mut vector: Vec<Complex64> =
        (0..n).map(|i| Complex64::from(1.0 / (1.0 + i as f64))).collect();
    for _ in 0..3 {
        let row = |i: usize| -> Vec<Complex64> {
            let entry = |j: usize| {
                let own = if i == j { near } else { Complex64::ZERO };
                Complex64::from(matrix[(i, j)]) - own
            };
            (0..n).map(entry).chain([vector[i]]).collect()
        };
        let rows = (0..n).map(row).collect();
        vector = solve(rows, |x: Complex64| x.norm());
        let largest = vector.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        if !(largest.norm().is_finite() && largest.norm() > 0.0) {
            return None;
        }
        vector.iter_mut().for_each(|x| *x /= largest);
    }
    Some(vector)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigenvalues;

    #[test]
    fn eigenvectors_solve_their_equation() {
        let a = Matrix::from_fn(6, 6, |i, j| ((i * 7 + j * 3) % 11) as f64 - 5.0);
        for value in eigenvalues(&a).unwrap() {
            let x = eigenvector(&a, value).unwrap();
            for i in 0..6 {
                let moved: Complex64 = a.row(i).iter().zip(&x).map(|(a, x)| *a * x).sum();
                // Roundings of a matrix of norm 30.
                assert!((moved - value * x[i]).norm() < 1e-12, "{value} {i}");
            }
        }
    }
}
