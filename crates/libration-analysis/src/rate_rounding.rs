//! Rounding of the eigenvalues of a matrix.

use libration_linear::{Complex64, Matrix, eigenvector};

/// Roundings of each entry that may move an eigenvalue.
const ROUNDINGS: f64 = 8.0;

/// The distance by which roundings of the entries of `matrix` move its eigenvalue `value`; `values` are all of them.
///
/// It is `|yᵀ||A||x| / |yᵀx|` roundings with the vectors `x` and `y` of the eigenvalue (N. J. Higham, *Accuracy and Stability of Numerical
/// Algorithms*, 2nd ed., section 26.5), large for matrices far from normal ones. Where `m` eigenvalues are near each other it is at
/// most the `m`-th root of a rounding, by which a Jordan block of them is parted.
pub fn eigenvalue_rounding(matrix: &Matrix, value: Complex64, values: &[Complex64]) -> f64 {
    let n = matrix.rows();
    let size = matrix.row_sum_norm();
    let rounding = ROUNDINGS * n as f64 * f64::EPSILON;
    let parted = (1..=n).filter_map(|m| {
        let distance = size * rounding.powf((m as f64).recip());
        let near = values.iter().filter(|other| (*other - value).norm() <= 2.0 * distance);
        (near.count() >= m).then_some(distance)
    });
    let parted = parted.fold(size * rounding, f64::max);
    let vectors = eigenvector(matrix, value).zip(eigenvector(&matrix.transposed(), value));
    let Some((right, left)) = vectors else { return parted };
    let product: Complex64 = left.iter().zip(&right).map(|(y, x)| y * x).sum();
    let sizes: f64 = (0..n)
        .map(|i| {
            let row: f64 = (0..n).map(|j| matrix[(i, j)].abs() * right[j].norm()).sum();
            left[i].norm() * row
        })
        .sum();
    match product.norm() {
        0.0 => parted,
        product => (rounding * sizes / product).min(parted),
    }
}

#[cfg(test)]
mod tests {
    use libration_linear::eigenvalues;

    use super::*;

    /// The largest distance of the eigenvalues of a matrix, which are all `wanted`, with the bounds.
    fn apart(matrix: &Matrix, wanted: f64) -> [f64; 2] {
        let values = eigenvalues(matrix).unwrap();
        let of = |of: &dyn Fn(Complex64) -> f64| values.iter().map(|&x| of(x)).fold(0.0, f64::max);
        [of(&|x| (x - wanted).norm()), of(&|x| eigenvalue_rounding(matrix, x, &values))]
    }

    #[test]
    fn the_bound_holds_for_jordan_blocks_and_is_no_larger_than_their_root() {
        // A Jordan block of zeros, in other coordinates.
        for n in [2, 3, 4] {
            let block = Matrix::from_fn(n, n, |i, j| f64::from(u8::from(j == i + 1)));
            let basis = Matrix::from_fn(n, n, |i, j| {
                f64::from(u8::from(i == j)) + 0.3 / (1.0 + (i + 2 * j) as f64)
            });
            let inverse = libration_linear::solve_matrix(&basis, &Matrix::identity(n)).unwrap();
            let moved = &(&basis * &block) * &inverse;
            let [distance, bound] = apart(&moved, 0.0);
            assert!(distance <= bound, "{n} {distance} {bound}");
            let root = (64.0 * f64::EPSILON * n as f64).powf((n as f64).recip());
            assert!(bound <= 4.0 * root, "{n} {bound} {root}");
        }
    }

    #[test]
    fn eigenvalues_that_repeat_without_a_jordan_block_and_small_ones_beside_large_ones_are_known() {
        let twins = Matrix::diagonal(&[1.0, 1.0, 1.0]);
        assert!(apart(&twins, 1.0)[1] < 1e-4);
        let stiff = Matrix::diagonal(&[-1e-9, -1e10]);
        let values = eigenvalues(&stiff).unwrap();
        let slow = values.iter().find(|value| value.norm() < 1.0).unwrap();
        assert!(eigenvalue_rounding(&stiff, *slow, &values) < 1e-20);
    }
}
