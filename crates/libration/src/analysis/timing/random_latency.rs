//! Commands whose latency is random.

use super::{Feedback, HeldStep, Plant};
use crate::State;
use crate::number::Wide;

/// Latencies of whole steps, each with its probability, drawn for every step: with the hold probability the last
/// one stays, otherwise one is drawn anew.
///
/// At step `k` with latency `d` the command of step `k − d` acts. So commands may overtake each other, and one that
/// was overtaken may act after a later one did.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomLatency {
    table: Vec<(usize, f64)>,
    hold: f64,
}

/// What is wrong with a table of latencies.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LatencyTableError {
    /// There is nothing to draw from.
    #[error("the table has no latencies")]
    Empty,
    /// The matrix of second moments would be too large.
    #[error(
        "{entries} latencies of up to {longest} steps make {moments} second moments; there may be at most \
         {MOST_MOMENTS}"
    )]
    Size {
        /// How many there are in the table.
        entries: usize,
        /// The longest of them.
        longest: usize,
        /// How many moments that makes.
        moments: usize,
    },
    /// A probability is none.
    #[error("a probability is {0}; it must be a number from 0 to 1")]
    Probability(f64),
    /// The probabilities are not those of a table.
    #[error("the probabilities sum to {0}; they must sum to 1, within 10⁻¹²")]
    Sum(f64),
}

/// Beyond, the powers of the matrix take minutes.
const MOST_MOMENTS: usize = 600;

impl RandomLatency {
    /// Latencies with their probabilities, drawn anew for every step but with probability `hold`.
    ///
    /// # Errors
    /// A [`LatencyTableError`].
    pub fn new(table: Vec<(usize, f64)>, hold: f64) -> Result<Self, LatencyTableError> {
        let Some(longest) = table.iter().map(|&(steps, _)| steps).max() else {
            return Err(LatencyTableError::Empty);
        };
        let (entries, n) = (table.len(), longest.saturating_add(2));
        let moments = entries.saturating_mul(n.saturating_mul(n.saturating_add(1)) / 2);
        if moments > MOST_MOMENTS {
            return Err(LatencyTableError::Size { entries, longest, moments });
        }
        let probabilities = || table.iter().map(|&(_, p)| p);
        if let Some(p) = probabilities().chain([hold]).find(|p| !(0.0..=1.0).contains(p)) {
            return Err(LatencyTableError::Probability(p));
        }
        let sum: f64 = probabilities().sum();
        if (sum - 1.0).abs() > 1e-12 {
            return Err(LatencyTableError::Sum(sum));
        }
        Ok(RandomLatency { table, hold })
    }

    /// The latencies in steps, each with its probability.
    pub fn table(&self) -> &[(usize, f64)] {
        &self.table
    }

    /// The probability that a latency stays for another step.
    pub fn hold(&self) -> f64 {
        self.hold
    }

    /// The longest latency, in steps.
    pub fn longest(&self) -> usize {
        self.table.iter().map(|&(steps, _)| steps).max().unwrap_or(0)
    }

    /// The probability that entry `next` follows entry `now`.
    fn follows(&self, now: usize, next: usize) -> f64 {
        let stays = if now == next { self.hold } else { 0.0 };
        stays + (1.0 - self.hold) * self.table[next].1
    }
}

/// A square matrix, row by row.
type Matrix = Vec<Vec<f64>>;

impl Plant<'_> {
    /// The factor by which second moments grow in a step of the loop that `feedback` closes with random latencies.
    /// The loop is stable in the mean square where it is below 1.
    ///
    /// It is the spectral radius of the map `Pⱼ ← Σᵢ πᵢⱼ Mᵢ Pᵢ Mᵢᵀ` of second moments by latency, with the step `Mᵢ` of
    /// state and waiting commands (O. L. V. Costa, M. D. Fragoso, R. P. Marques, *Discrete-Time Markov Jump Linear
    /// Systems*, 2005, chapter 3).
    pub fn mean_square_late(&self, feedback: Feedback, latency: &RandomLatency) -> f64 {
        let steps = self.steps_late(feedback, latency);
        let squares: Vec<Matrix> = steps.iter().map(symmetric_square).collect();
        let (m, size) = (steps.len(), squares[0].len());
        let entry = |row: usize, column: usize| {
            let ((j, r), (i, c)) = ((row / size, row % size), (column / size, column % size));
            latency.follows(i, j) * squares[i][r][c]
        };
        radius((0..m * size).map(|r| (0..m * size).map(|c| entry(r, c)).collect()).collect())
    }

    /// `E[q²]`, `E[qv]` and `E[v²]` after so many steps of that loop from `state`, where nothing acts before the first
    /// command arrives.
    pub fn moments_late(
        &self,
        feedback: Feedback,
        latency: &RandomLatency,
        state: &State<f64, 1>,
        steps: u64,
    ) -> [f64; 3] {
        let maps = self.steps_late(feedback, latency);
        let n = maps[0].len();
        let start: Vec<f64> =
            (0..n).map(|i| [state.q[0], state.v[0]].get(i).copied().unwrap_or(0.0)).collect();
        // E[yyᵀ; the latency is the i-th].
        let of = |p: f64| start.iter().map(|a| start.iter().map(|b| p * a * b).collect()).collect();
        let mut moments: Vec<Matrix> = latency.table.iter().map(|&(_, p)| of(p)).collect();
        for _ in 0..steps {
            let moved: Vec<Matrix> = maps
                .iter()
                .zip(&moments)
                .map(|(map, moment)| transposed(&product(map, &transposed(&product(map, moment)))))
                .collect();
            let entry = |j: usize, r: usize, c: usize| -> f64 {
                moved.iter().enumerate().map(|(i, m)| latency.follows(i, j) * m[r][c]).sum()
            };
            moments = (0..maps.len())
                .map(|j| (0..n).map(|r| (0..n).map(|c| entry(j, r, c)).collect()).collect())
                .collect();
        }
        [(0, 0), (0, 1), (1, 1)].map(|(r, c)| moments.iter().map(|moment| moment[r][c]).sum())
    }

    /// The step with each latency of the table.
    fn steps_late(&self, feedback: Feedback, latency: &RandomLatency) -> Vec<Matrix> {
        let held = (self.step)(self.dt);
        let of = |&(d, _): &(usize, f64)| augmented(&held, feedback, d, latency.longest());
        latency.table.iter().map(of).collect()
    }
}

fn transposed(m: &Matrix) -> Matrix {
    (0..m.len()).map(|i| m.iter().map(|row| row[i]).collect()).collect()
}

/// The spectral radius: the growth of the norm of higher and higher powers (I. Gelfand, 1941), each the square of the
/// one before. After 50 of them what norm and radius differ by is divided by 2⁵⁰.
fn radius(mut power: Matrix) -> f64 {
    let (mut logarithm, mut share) = (0.0, 1.0);
    for _ in 0..50 {
        let norm = power.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        if norm == 0.0 {
            return 0.0;
        }
        logarithm += share * norm.ln();
        share /= 2.0;
        power.iter_mut().flatten().for_each(|x| *x /= norm);
        power = product(&power, &power);
    }
    logarithm.exp()
}

/// What a matrix makes of the products `xᵢxⱼ`, `i ≤ j`.
fn symmetric_square(m: &Matrix) -> Matrix {
    let n = m.len();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).collect();
    let entry = |(i, j): (usize, usize), (k, l): (usize, usize)| match k == l {
        true => m[i][k] * m[j][k],
        false => m[i][k] * m[j][l] + m[i][l] * m[j][k],
    };
    pairs.iter().map(|&row| pairs.iter().map(|&column| entry(row, column)).collect()).collect()
}

/// The step of state and waiting commands `(q, v, u₋₁, …)` where the command of `d` steps ago acts.
fn augmented(held: &HeldStep, feedback: Feedback, d: usize, longest: usize) -> Matrix {
    let n = 2 + longest;
    let number = Wide::to_f64;
    let gains = [feedback.position, feedback.velocity];
    let gamma = [number(held.gamma.q[0]), number(held.gamma.v[0])];
    let mut matrix = vec![vec![0.0; n]; n];
    for i in 0..2 {
        for j in 0..2 {
            let now = if d == 0 { -gamma[i] * gains[j] } else { 0.0 };
            matrix[i][j] = number(held.phi.entry(i, j)) + now;
        }
        if d > 0 {
            matrix[i][1 + d] = gamma[i];
        }
    }
    if longest > 0 {
        matrix[2][..2].copy_from_slice(&gains.map(|gain| -gain));
    }
    for i in 3..n {
        matrix[i][i - 1] = 1.0;
    }
    matrix
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let row = |a: &Vec<f64>| {
        let mut row = vec![0.0; b.len()];
        for (&factor, b) in a.iter().zip(b).filter(|(factor, _)| **factor != 0.0) {
            row.iter_mut().zip(b).for_each(|(x, b)| *x += factor * b);
        }
        row
    };
    a.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_that_are_none_are_refused_in_words() {
        let refused = |table, hold| RandomLatency::new(table, hold).unwrap_err().to_string();
        assert!(refused(vec![], 0.0).contains("no latencies"));
        assert!(refused(vec![(0, 0.5), (2, 0.4)], 0.0).contains("sum to 0.9"));
        assert!(refused(vec![(0, 1.5), (2, -0.5)], 0.0).contains("1.5"));
        assert!(refused(vec![(0, 1.0)], f64::NAN).contains("NaN"));
        assert!(refused(vec![(65, 1.0)], 0.0).contains("2278 second moments"));
        assert!(refused(vec![(usize::MAX, 1.0)], 0.0).contains("at most 600"));
    }
}
