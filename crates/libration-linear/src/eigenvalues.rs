//! Eigenvalues of real matrices.
//!
//! Our own, because `faer` would add a hundred seconds of processor time to a build for this one function (DESIGN.md).

use num_complex::Complex64;

use crate::Matrix;
use crate::hessenberg::{HessenbergForm, Reflection};

/// All eigenvalues of a square matrix, pairs next to each other; none if an entry is infinite or NaN, or the iteration does not
/// settle.
///
/// Of the balanced Hessenberg form, by Francis' implicit double shifts (G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed.,
/// section 7.5).
pub fn eigenvalues(matrix: &Matrix) -> Option<Vec<Complex64>> {
    if !matrix.is_finite() {
        return None;
    }
    HessenbergForm::new(matrix).eigenvalues()
}

impl HessenbergForm {
    /// All eigenvalues, pairs next to each other.
    pub(crate) fn eigenvalues(&self) -> Option<Vec<Complex64>> {
        solve_hessenberg(&mut self.h.clone())
    }
}

/// Iterations for one eigenvalue; it takes two or three.
const MOST: usize = 60;

/// The eigenvalues of a Hessenberg matrix, by double shifts, of which the last rows split off one by one or in pairs.
fn solve_hessenberg(h: &mut Matrix) -> Option<Vec<Complex64>> {
    let mut values = Vec::with_capacity(h.rows());
    let size = h.row_sum_norm();
    let mut end = h.rows();
    let mut iterations = 0;
    while end > 0 {
        // The last block that no zero below the diagonal divides.
        let negligible = |k: usize| {
            let beside = h[(k, k)].abs() + h[(k - 1, k - 1)].abs();
            let beside = if beside == 0.0 { size } else { beside };
            h[(k, k - 1)].abs() <= f64::EPSILON * beside
        };
        let begin = (1..end).rev().find(|&k| negligible(k)).unwrap_or(0);
        if begin > 0 {
            // For good: sweeps of the block leave the rows above it as they are.
            h[(begin, begin - 1)] = 0.0;
        }
        match end - begin {
            1 => values.push(Complex64::from(h[(begin, begin)])),
            2 => values.extend(pair(h, begin)),
            _ if iterations == MOST => return None,
            _ => {
                iterations += 1;
                sweep(h, begin..end, iterations);
                continue;
            }
        }
        end = begin;
        iterations = 0;
    }
    Some(values)
}

/// The eigenvalues of the block of two rows that begins at `k`.
fn pair(h: &Matrix, k: usize) -> [Complex64; 2] {
    let [a, b, c, d] = [h[(k, k)], h[(k, k + 1)], h[(k + 1, k)], h[(k + 1, k + 1)]];
    let (mean, half) = (0.5 * (a + d), 0.5 * (a - d));
    let square = half * half + b * c;
    if square < 0.0 {
        let im = (-square).sqrt();
        return [Complex64::new(mean, im), Complex64::new(mean, -im)];
    }
    // The larger first; the smaller follows from the product, without cancellation.
    let far = mean + square.sqrt().copysign(mean);
    let product = a * d - b * c;
    let near = if far == 0.0 { 0.0 } else { product / far };
    [Complex64::from(far), Complex64::from(near)]
}

/// An implicit double shift on a block.
fn sweep(h: &mut Matrix, block: core::ops::Range<usize>, iterations: usize) {
    let (begin, end) = (block.start, block.end);
    let n = end - 1;
    let mut shifts = pair(h, n - 1);
    if iterations.is_multiple_of(10) {
        // Shifts that break circles.
        let size = h[(n, n - 1)].abs() + h[(n - 1, n - 2)].abs();
        let shift = h[(n, n)] + 0.75 * size;
        shifts = [Complex64::new(shift, size), Complex64::new(shift, -size)];
    }
    // The first column of (H − a)(H − b), by differences: of almost equal eigenvalues nothing else is left.
    let [h00, h10, h11] = [h[(begin, begin)], h[(begin + 1, begin)], h[(begin + 1, begin + 1)]];
    let [off, beside] = shifts.map(|shift| h00 - shift);
    let mut x = vec![
        (off * beside).re + h[(begin, begin + 1)] * h10,
        h10 * ((h00 - shifts[0].re) + (h11 - shifts[1].re)),
        h10 * h[(begin + 2, begin + 1)],
    ];
    for k in begin..n {
        if k > begin {
            x = (k..(k + 3).min(end)).map(|i| h[(i, k - 1)]).collect();
        } else if end - k < 3 {
            x.truncate(end - k);
        }
        let Some(reflection) = Reflection::onto_first(&x) else { continue };
        let left = if k > begin { k - 1 } else { k };
        reflection.reflect_rows(h, k, left..end);
        reflection.reflect_columns(h, k, begin..(k + 4).min(end));
        if k > begin {
            (k + 1..(k + 3).min(end)).for_each(|i| h[(i, k - 1)] = 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complex_eigenvalues::complex_eigenvalues;
    use crate::solve_matrix;

    fn sorted(mut values: Vec<Complex64>) -> Vec<Complex64> {
        values.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        values
    }

    /// Entries between −1/2 and 1/2.
    fn random(n: usize, state: &mut u64) -> Matrix {
        let mut a = Matrix::zeros(n, n);
        for x in a.entries_mut() {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            *x = (*state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5;
        }
        a
    }

    /// The companion matrix of the polynomial with these roots.
    fn companion(roots: &[f64]) -> Matrix {
        let mut coefficients = vec![1.0];
        for root in roots {
            coefficients.push(0.0);
            for i in (1..coefficients.len()).rev() {
                coefficients[i] -= root * coefficients[i - 1];
            }
        }
        Matrix::from_fn(roots.len(), roots.len(), |i, j| match (i, j) {
            (0, j) => -coefficients[j + 1],
            (i, j) => f64::from(u8::from(i == j + 1)),
        })
    }

    #[test]
    fn roots_of_polynomials_are_found() {
        let wanted: Vec<f64> = (1..=8).map(f64::from).collect();
        for (found, wanted) in
            sorted(eigenvalues(&companion(&wanted)).unwrap()).into_iter().zip(wanted)
        {
            // The roots of Wilkinson's polynomial of degree 8 have conditions up to 10⁴.
            assert!((found - wanted).norm() < 1e-10, "{found} {wanted}");
        }
    }

    #[test]
    fn matrices_that_trap_plain_iterations_are_solved() {
        // A permutation, whose eigenvalues are roots of unity, and one on which a well-known library never ends.
        let turn = Matrix::from_fn(5, 5, |i, j| f64::from(u8::from((i + 1) % 5 == j)));
        for found in eigenvalues(&turn).unwrap() {
            assert!((found.norm() - 1.0).abs() < 1e-14, "{found}");
            assert!((found.powi(5) - 1.0).norm() < 1e-13, "{found}");
        }
        let hard =
            Matrix::from_rows(&[[1.0, 1.0, 0.0], [-1.0, 1.0, -1.0], [0.0, 1.0, 1.0]]).unwrap();
        let mut found = eigenvalues(&hard).unwrap();
        found.sort_by(|a, b| a.im.total_cmp(&b.im));
        // (1 − λ)((1 − λ)² + 2).
        let root = 2.0_f64.sqrt();
        for (found, wanted) in found.into_iter().zip([-root, 0.0, root]) {
            assert!((found - Complex64::new(1.0, wanted)).norm() < 1e-14, "{found}");
        }
    }

    #[test]
    fn badly_scaled_matrices_are_balanced_first() {
        let scales = [1e-9, 1.0, 1e6, 1e12];
        let plain = companion(&[-1.0, -2.0, -3.0, -4.0]);
        let bad = Matrix::from_fn(4, 4, |i, j| plain[(i, j)] * scales[i] / scales[j]);
        for (found, wanted) in
            sorted(eigenvalues(&bad).unwrap()).into_iter().zip([-4.0, -3.0, -2.0, -1.0])
        {
            assert!((found - wanted).norm() < 1e-11, "{found} {wanted}");
        }
    }

    #[test]
    fn sums_and_products_of_eigenvalues_are_trace_and_determinant() {
        let mut state = 1;
        for n in [1, 2, 3, 10, 40, 90] {
            let a = random(n, &mut state);
            let values = eigenvalues(&a).unwrap();
            let [sum, square] =
                [1, 2].map(|power| values.iter().map(|x| x.powi(power)).sum::<Complex64>());
            assert!((sum - a.trace()).norm() < 1e-12, "{n}");
            assert!((square - (&a * &a).trace()).norm() < 1e-11, "{n}");
        }
    }

    #[test]
    fn eigenvalues_that_repeat_are_found() {
        let wanted = [-0.0465, -0.0465, 0.0, 0.0, 0.0, 0.0465, 0.0465, 0.0465, 0.0465];
        for seed in 1..200 {
            let basis = random(9, &mut { seed });
            let a = solve_matrix(&basis, &(&Matrix::diagonal(&wanted) * &basis)).unwrap();
            let inverse = solve_matrix(&basis, &Matrix::identity(9)).unwrap();
            let condition = basis.row_sum_norm() * inverse.row_sum_norm();
            // A change of the matrix moves eigenvalues by at most that times the condition of the basis (F. L. Bauer, C. T. Fike,
            // Numerische Mathematik 2, 1960).
            let rounding = f64::EPSILON * a.row_sum_norm() * condition;
            let entries = a.entries().iter().map(|&x| Complex64::from(x)).collect();
            for found in [eigenvalues(&a).unwrap(), complex_eigenvalues(entries, 9)] {
                for (found, wanted) in sorted(found).into_iter().zip(wanted) {
                    assert!((found - wanted).norm() < rounding, "{seed}: {found} {wanted}");
                }
            }
        }
    }
}
