//! Factors of a matrix, for several right sides.

use libration_core::Float;

/// A square matrix as the product of a lower and an upper triangle, with partial pivoting.
#[derive(Clone, Debug)]
pub(crate) struct Factorisation<S> {
    /// The factors of each elimination below the diagonal, the rest on and above it.
    entries: Vec<S>,
    /// The row of the matrix at each place.
    rows: Vec<usize>,
}

impl<S: Float> Factorisation<S> {
    /// The factors of a matrix with `n` rows, row by row. Of a singular one solutions are not finite.
    pub(crate) fn new(mut entries: Vec<S>, n: usize) -> Self {
        let mut rows: Vec<usize> = (0..n).collect();
        for k in 0..n {
            let size = |i: usize| entries[i * n + k].to_f64().abs();
            let largest = (k..n).max_by(|&i, &j| size(i).total_cmp(&size(j))).unwrap_or(k);
            rows.swap(k, largest);
            for j in 0..n {
                entries.swap(k * n + j, largest * n + j);
            }
            let (above, below) = entries.split_at_mut((k + 1) * n);
            let pivot = &above[k * n..];
            for row in below.chunks_exact_mut(n) {
                let factor = row[k].quotient(pivot[k]);
                row[k] = factor;
                for (x, &p) in row[k + 1..].iter_mut().zip(&pivot[k + 1..]) {
                    *x = *x - factor * p;
                }
            }
        }
        Factorisation { entries, rows }
    }

    /// Solves the equations with the right side `x`, and leaves the solution there.
    pub(crate) fn solve(&self, x: &mut [S]) {
        let n = self.rows.len();
        let mut y: Vec<S> = self.rows.iter().map(|&row| x[row]).collect();
        for k in 0..n {
            let row = &self.entries[k * n..k * n + k];
            y[k] = row.iter().zip(&y).fold(y[k], |rest, (&a, &y)| rest - a * y);
        }
        for k in (0..n).rev() {
            let row = &self.entries[k * n..(k + 1) * n];
            let terms = row[k + 1..].iter().zip(&y[k + 1..]);
            y[k] = terms.fold(y[k], |rest, (&a, &y)| rest - a * y).quotient(row[k]);
        }
        x.copy_from_slice(&y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_with_a_zero_pivot_are_solved() {
        // y + z = 5, x − z = −2, 2x + y = 4 at (1, 2, 3).
        let matrix = vec![0.0, 1.0, 1.0, 1.0, 0.0, -1.0, 2.0, 1.0, 0.0];
        let mut x = [5.0, -2.0, 4.0];
        Factorisation::new(matrix, 3).solve(&mut x);
        assert_eq!(x, [1.0, 2.0, 3.0]);
    }
}
