//! Stein's equation, the discrete Lyapunov equation.

use crate::Matrix;

/// The solution of `P = M P Mᵀ + W` for each `W`, with a stable `M`: the sum of all that ever came in, doubled again and again
/// (R. A. Smith, *Matrix equation XA + BX = C*, SIAM Journal on Applied Mathematics 16, 1968).
pub fn solve_stein(step: &Matrix, mut sums: Vec<Matrix>) -> Vec<Matrix> {
    let mut power = step.clone();
    // A loop whose moments fall by 10⁻¹⁵ a step has forgotten after 2⁵⁶.
    for _ in 0..56 {
        for sum in &mut sums {
            let more = power.congruence(sum);
            sum.add_scaled(1.0, &more);
        }
        power = &power * &power;
        power.normalise(1.0);
        // The rest is less than a rounding of the whole.
        if power.rows() as f64 * power.largest() < 1e-20 {
            break;
        }
    }
    sums
}

/// The map of the products `xᵢxⱼ`, `i ≤ j`, under a matrix.
pub fn symmetric_square(m: &Matrix) -> Matrix {
    let n = m.rows();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).collect();
    Matrix::from_fn(pairs.len(), pairs.len(), |row, column| {
        let ((i, j), (k, l)) = (pairs[row], pairs[column]);
        match k == l {
            true => m[(i, k)] * m[(j, k)],
            false => m[(i, k)] * m[(j, l)] + m[(i, l)] * m[(j, k)],
        }
    })
}
