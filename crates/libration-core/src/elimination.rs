//! Linear equations within a step, by elimination without pivots that depend on data.

use crate::Elementary;

/// Solves `matrix · x = right` and leaves `x` in `right`. The matrix has as many rows as `right`, row by row, and is overwritten.
///
/// Each row eliminates the next ones in their order, so that a step has the same operations whatever its numbers are. For the matrices
/// `1 − hD − h²K` of an implicit step, with `D` and `K` over the masses, this is as accurate as Cholesky's method where the masses or
/// both dampers and springs are diagonal: the matrix then is a symmetric positive definite one, times a positive diagonal from the left
/// (masses) or from the right (springs and dampers of joints), which scales the pivots and changes none of their signs. It also is where
/// the diagonal dominates, as in small steps. Otherwise a pivot may be small, and the solution lose digits (N. J. Higham: Accuracy and
/// Stability of Numerical Algorithms, 2nd ed., §9.5 and §10.1).
pub fn solve<S: Elementary>(matrix: &mut [S], right: &mut [S]) {
    let n = right.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = matrix[i * n + k].quotient(matrix[k * n + k]);
            for j in k + 1..n {
                matrix[i * n + j] = matrix[i * n + j] - factor * matrix[k * n + j];
            }
            right[i] = right[i] - factor * right[k];
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            right[k] = right[k] - matrix[k * n + j] * right[j];
        }
        right[k] = right[k].quotient(matrix[k * n + k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_equations_are_solved() {
        // 2x + y = 4, x − z = −2, y + z = 5 at (1, 2, 3).
        let mut matrix = [2.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 1.0];
        let mut right = [4.0, -2.0, 5.0];
        solve(&mut matrix, &mut right);
        assert_eq!(right, [1.0, 2.0, 3.0]);
    }
}
