//! Singular values and their vectors.

use crate::Matrix;

/// The decomposition `A = U diag(σ) Vᵀ` of a matrix, the largest singular value first.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularValues {
    /// One for each column of the matrix.
    pub values: Vec<f64>,
    /// `U`: rows of the matrix × its columns. The vector of a value of zero is zero.
    pub left: Matrix,
    /// `V`: columns × columns, orthogonal.
    pub right: Matrix,
}

/// Sweeps of the iteration; it takes ten.
const SWEEPS: usize = 60;

impl SingularValues {
    /// Those of a matrix; none if an entry is infinite or NaN.
    ///
    /// By rotations of pairs of columns until all are orthogonal, which keeps small values exact to their own rounding (J. Demmel,
    /// K. Veselić, SIAM Journal on Matrix Analysis and Applications 13, 1992).
    pub fn of(matrix: &Matrix) -> Option<Self> {
        if !matrix.is_finite() {
            return None;
        }
        let n = matrix.columns();
        // Rows are what a rotation of columns moves.
        let (mut columns, mut right) = (matrix.transposed(), Matrix::identity(n));
        for _ in 0..SWEEPS {
            let mut is_orthogonal = true;
            for i in 0..n {
                for j in i + 1..n {
                    is_orthogonal &= !rotate(&mut columns, &mut right, i, j);
                }
            }
            if is_orthogonal {
                break;
            }
        }
        let norm = |i: usize| columns.row(i).iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut order: Vec<(f64, usize)> = (0..n).map(|i| (norm(i), i)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        let unit = |x: f64, size: f64| if size > 0.0 { x / size } else { 0.0 };
        let left = Matrix::from_fn(matrix.rows(), n, |i, k| {
            let (size, column) = order[k];
            unit(columns[(column, i)], size)
        });
        let sorted = Matrix::from_fn(n, n, |i, k| right[(order[k].1, i)]);
        right = sorted;
        Some(SingularValues {
            values: order.into_iter().map(|(size, _)| size).collect(),
            left,
            right,
        })
    }

    /// How many values exceed a part of the largest.
    pub fn rank(&self, part: f64) -> usize {
        let most = self.values.first().copied().unwrap_or(0.0);
        self.values.iter().filter(|&&value| value > part * most).count()
    }
}

/// Makes two rows orthogonal; returns whether they were not.
fn rotate(rows: &mut Matrix, right: &mut Matrix, i: usize, j: usize) -> bool {
    let inner = |a: usize, b: usize| -> f64 {
        rows.row(a).iter().zip(rows.row(b)).map(|(x, y)| x * y).sum()
    };
    let [own, other, both] = [inner(i, i), inner(j, j), inner(i, j)];
    if both == 0.0 || both.abs() <= f64::EPSILON * (own * other).sqrt() {
        return false;
    }
    let zeta = (other - own) / (2.0 * both);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    let sine = cosine * tangent;
    for matrix in [rows, right] {
        for k in 0..matrix.columns() {
            let (x, y) = (matrix[(i, k)], matrix[(j, k)]);
            (matrix[(i, k)], matrix[(j, k)]) = (cosine * x - sine * y, sine * x + cosine * y);
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factors_multiply_to_the_matrix_and_small_values_are_exact() {
        // Two rotations around a diagonal of 3, 1e-9 and 0.
        let turn = |angle: f64| {
            let (s, c) = angle.sin_cos();
            Matrix::from_rows(&[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).unwrap()
        };
        let a = &(&turn(0.3) * &Matrix::diagonal(&[3.0, 1e-9, 0.0])) * &turn(1.1);
        let found = SingularValues::of(&a).unwrap();
        assert!((found.values[0] - 3.0).abs() < 1e-15 && found.values[2] == 0.0, "{found:?}");
        // Roundings of the entries move a singular value by as much.
        assert!((found.values[1] - 1e-9).abs() < 3e-15, "{found:?}");
        assert_eq!((found.rank(1e-12), found.rank(1e-6)), (2, 1));
        let product = &(&found.left * &Matrix::diagonal(&found.values)) * &found.right.transposed();
        assert!(product.plus(&a.scaled(-1.0)).largest() < 1e-15);
        let square = &found.right.transposed() * &found.right;
        assert!(square.plus(&Matrix::identity(3).scaled(-1.0)).largest() < 1e-15);
    }

    #[test]
    fn a_wide_matrix_has_the_null_space_of_its_missing_rows() {
        let found = SingularValues::of(&Matrix::from_rows(&[[1.0, 1.0, 1.0]]).unwrap()).unwrap();
        assert_eq!(found.rank(1e-12), 1);
        for k in 1..3 {
            let sum: f64 = (0..3).map(|i| found.right[(i, k)]).sum();
            assert!(sum.abs() < 1e-15, "{found:?}");
        }
    }
}
