//! Cholesky's factor of a covariance.

use crate::Matrix;

/// `L` with `L Lᵀ = p`, lower triangular, for a positive semidefinite `p`.
///
/// A pivot that rounding does not tell from zero counts as zero, with its column: `L Lᵀ` differs from `p` by some `n` roundings of its
/// diagonal (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, theorem 10.14).
pub fn cholesky(p: &Matrix) -> Matrix {
    let n = p.rows();
    let mut l = Matrix::zeros(n, n);
    for j in 0..n {
        let pivot = p[(j, j)] - l.row(j)[..j].iter().map(|x| x * x).sum::<f64>();
        if pivot <= n as f64 * f64::EPSILON * p[(j, j)] {
            continue;
        }
        let root = pivot.sqrt();
        l[(j, j)] = root;
        for i in j + 1..n {
            let inner: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
            l[(i, j)] = (p[(i, j)] - inner) / root;
        }
    }
    l
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_of_the_factor_is_the_matrix_also_if_that_is_singular() {
        let h: f64 = 1e-3;
        let chain = Matrix::from_rows(&[[h.powi(3) / 3.0, h * h / 2.0], [h * h / 2.0, h]]);
        let rank_one =
            Matrix::from_fn(4, 4, |i, j| [0.0, 3.0, -1.0, 0.1][i] * [0.0, 3.0, -1.0, 0.1][j]);
        for p in [chain.unwrap(), rank_one, Matrix::zeros(3, 3)] {
            let l = cholesky(&p);
            let square = l.congruence(&Matrix::identity(p.rows()));
            for i in 0..p.rows() {
                for j in 0..p.rows() {
                    let scale = (p[(i, i)] * p[(j, j)]).sqrt();
                    // Four roundings of products that are no larger than the scale.
                    assert!((square[(i, j)] - p[(i, j)]).abs() <= 1e-15 * scale, "{i} {j} {l:?}");
                }
            }
        }
    }
}
