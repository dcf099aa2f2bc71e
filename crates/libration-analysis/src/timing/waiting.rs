//! A step of a loop with all that it has to know, and how its second moments grow.

use super::LinearController;
use super::split::Split;

/// A square matrix, row by row.
pub(super) type Matrix = Vec<Vec<f64>>;

/// What a step has to know, `(q, v, m, u₋₁, u₋₂, …, u)`: the state, what the controller remembers, the commands that wait and, where
/// steps split or commands may be lost, the one that acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) memory: usize,
    pub(super) commands: usize,
    pub(super) acting: bool,
}

impl Waiting {
    /// The number of its coordinates.
    pub(super) fn size(self) -> usize {
        2 + self.memory + self.commands + usize::from(self.acting)
    }

    /// The command that takes over, as what it is made of: that of `d` steps ago, or none, where it was lost and the one that acts
    /// goes on.
    pub(super) fn arriving(self, controller: &LinearController, d: Option<usize>) -> Vec<f64> {
        let mut row = vec![0.0; self.size()];
        match d {
            Some(0) => controller.command_row(&mut row),
            Some(d) => row[1 + self.memory + d] = 1.0,
            None => row = self.held(),
        }
        row
    }

    /// The command that acts before, as what it is made of.
    pub(super) fn held(self) -> Vec<f64> {
        let mut row = vec![0.0; self.size()];
        if let Some(last) = row.last_mut().filter(|_| self.acting) {
            *last = 1.0;
        }
        row
    }

    /// A step in which that command takes over.
    pub(super) fn step(
        self,
        step: &Split,
        controller: &LinearController,
        d: Option<usize>,
    ) -> Matrix {
        let n = self.size();
        let Split { phi, old, new } = step;
        let (arriving, held) = (self.arriving(controller, d), self.held());
        let mut matrix = vec![vec![0.0; n]; n];
        for (i, row) in matrix.iter_mut().enumerate().take(2) {
            for (x, (arriving, held)) in row.iter_mut().zip(arriving.iter().zip(&held)) {
                *x = new[i] * arriving + old[i] * held;
            }
            (0..2).for_each(|j| row[j] += phi[i][j]);
        }
        let first = 2 + self.memory;
        controller.memory_rows(&mut matrix[2..first]);
        if self.commands > 0 {
            controller.command_row(&mut matrix[first]);
        }
        for i in first + 1..first + self.commands {
            matrix[i][i - 1] = 1.0;
        }
        if self.acting {
            matrix[n - 1] = arriving;
        }
        matrix
    }
}

/// Rows for columns.
pub(super) fn transposed(m: &Matrix) -> Matrix {
    (0..m.len()).map(|i| m.iter().map(|row| row[i]).collect()).collect()
}

/// The logarithm of the spectral radius: the growth of the norm of higher and higher powers (I. Gelfand, 1941), each the square of
/// the one before. After 50 of them what norm and radius differ by is divided by 2⁵⁰. Where several of the largest eigenvalues meet,
/// rounding parts them, and three digits may be all that are right.
pub(super) fn growth(mut power: Matrix) -> f64 {
    let (mut logarithm, mut share) = (0.0, 1.0);
    for _ in 0..50 {
        // Squares of it could overflow.
        let norm = power
            .iter()
            .flatten()
            .fold(0.0, |most: f64, x| if x.abs() > most || x.is_nan() { x.abs() } else { most });
        if norm == 0.0 {
            return f64::NEG_INFINITY;
        }
        logarithm += share * norm.ln();
        share /= 2.0;
        scale(&mut power, norm);
        power = product(&power, &power);
    }
    logarithm
}

/// Whether the spectral radius is below 1, which is known sooner than what it is: a power of norm below 1 says yes, and one whose
/// eigenvalues add up to more than there are of them says no.
pub(super) fn decays(matrix: &Matrix) -> bool {
    let (mut power, mut logarithm) = (matrix.clone(), 0.0);
    for _ in 0..50 {
        let row_sum = |row: &Vec<f64>| row.iter().map(|x| x.abs()).sum::<f64>();
        let norm = power.iter().map(row_sum).fold(0.0, |most: f64, x| match x.is_nan() {
            true => x,
            false => most.max(x),
        });
        if norm == 0.0 || norm.ln() + logarithm < 0.0 {
            return true;
        }
        let trace: f64 = power.iter().enumerate().map(|(i, row)| row[i]).sum();
        if norm.is_nan() || trace.abs().ln() + logarithm > (power.len() as f64).ln() {
            return false;
        }
        scale(&mut power, norm);
        logarithm = 2.0 * (logarithm + norm.ln());
        power = product(&power, &power);
    }
    // Within a part of 10⁻¹⁵ of the edge.
    growth(matrix.clone()) < 0.0
}

/// Divides all entries; those that are nothing beside the largest become zero, since products of them would be numbers with which
/// processors take a hundred times as long.
pub(super) fn scale(power: &mut Matrix, norm: f64) {
    const NOTHING: f64 = 1e-150;
    for x in power.iter_mut().flatten() {
        *x /= norm;
        *x = if x.abs() < NOTHING { 0.0 } else { *x };
    }
}

/// What a matrix makes of the products `xᵢxⱼ`, `i ≤ j`.
pub(super) fn symmetric_square(m: &Matrix) -> Matrix {
    let n = m.len();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).collect();
    let entry = |(i, j): (usize, usize), (k, l): (usize, usize)| match k == l {
        true => m[i][k] * m[j][k],
        false => m[i][k] * m[j][l] + m[i][l] * m[j][k],
    };
    pairs.iter().map(|&row| pairs.iter().map(|&column| entry(row, column)).collect()).collect()
}

/// Their product.
pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let row = |a: &Vec<f64>| {
        let mut row = vec![0.0; b.len()];
        for (&factor, b) in a.iter().zip(b).filter(|(factor, _)| **factor != 0.0) {
            row.iter_mut().zip(b).for_each(|(x, b)| *x += factor * b);
        }
        row
    };
    a.iter().map(row).collect()
}
