//! Commands whose latency is random.

use super::waiting::{Matrix, Waiting, growth, product, symmetric_square, transposed};
use super::{Feedback, Latency, LinearController, Plant};
use crate::State;

/// Latencies, each with its probability, drawn for every step: with the hold probability the last one stays, otherwise
/// one is drawn anew.
///
/// In step `k` with latency `d` the command of step `k − ⌊d⌋` begins to act, after the part of the step that is left of
/// `d`. So commands may overtake each other, and one that was overtaken may act after a later one did.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomLatency {
    table: Vec<(Latency, f64)>,
    hold: f64,
}

/// What is wrong with a table of latencies.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LatencyTableError {
    /// There is nothing to draw from.
    #[error("the table has no latencies")]
    Empty,
    /// A latency is none.
    #[error("a latency is {0} steps; it must be at least 0 and at most {most}", most = Latency::MOST_STEPS)]
    Latency(f64),
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
    /// Latencies in steps with their probabilities, drawn anew for every step but with probability `hold`.
    ///
    /// # Errors
    /// A [`LatencyTableError`].
    pub fn new(table: Vec<(f64, f64)>, hold: f64) -> Result<Self, LatencyTableError> {
        if table.is_empty() {
            return Err(LatencyTableError::Empty);
        }
        let entry = |&(steps, probability): &(f64, f64)| {
            let latency = Latency::of_steps(steps).ok_or(LatencyTableError::Latency(steps))?;
            Ok((latency, probability))
        };
        let table = table.iter().map(entry).collect::<Result<Vec<_>, LatencyTableError>>()?;
        let latency = RandomLatency { table, hold };
        let (entries, longest, n) =
            (latency.table.len(), latency.longest(), latency.waiting().size());
        let moments = entries.saturating_mul(n * (n + 1) / 2);
        if moments > MOST_MOMENTS {
            return Err(LatencyTableError::Size { entries, longest, moments });
        }
        let table = &latency.table;
        let probabilities = || table.iter().map(|&(_, p)| p);
        if let Some(p) = probabilities().chain([hold]).find(|p| !(0.0..=1.0).contains(p)) {
            return Err(LatencyTableError::Probability(p));
        }
        let sum: f64 = probabilities().sum();
        if (sum - 1.0).abs() > 1e-12 {
            return Err(LatencyTableError::Sum(sum));
        }
        Ok(latency)
    }

    /// The latencies, each with its probability.
    pub fn table(&self) -> &[(Latency, f64)] {
        &self.table
    }

    /// The probability that a latency stays for another step.
    pub fn hold(&self) -> f64 {
        self.hold
    }

    /// The whole steps of the longest latency.
    pub fn longest(&self) -> usize {
        self.table.iter().map(|(latency, _)| latency.whole() as usize).max().unwrap_or(0)
    }

    /// What a step has to know.
    fn waiting(&self) -> Waiting {
        let splits = self.table.iter().any(|(latency, _)| latency.part() > 0.0);
        Waiting { memory: 0, commands: self.longest(), acting: splits }
    }

    /// The probability that entry `next` follows entry `now`.
    fn follows(&self, now: usize, next: usize) -> f64 {
        let stays = if now == next { self.hold } else { 0.0 };
        stays + (1.0 - self.hold) * self.table[next].1
    }
}

impl Plant<'_> {
    /// The factor by which second moments grow in a step of the loop that `feedback` closes with random latencies.
    /// The loop is stable in the mean square where it is below 1.
    ///
    /// It is the spectral radius of the map `Pⱼ ← Σᵢ πᵢⱼ Mᵢ Pᵢ Mᵢᵀ` of second moments by latency, with the step `Mᵢ` of
    /// state and waiting commands, in `f64`: some 13 digits are right, but only 3 where the largest eigenvalues meet, as at critical
    /// damping (O. L. V. Costa, M. D. Fragoso, R. P. Marques, *Discrete-Time Markov Jump Linear
    /// Systems*, 2005, chapter 3).
    pub fn mean_square_late(&self, feedback: Feedback, latency: &RandomLatency) -> f64 {
        let steps = self.steps_late(feedback, latency);
        let squares: Vec<Matrix> = steps.iter().map(symmetric_square).collect();
        let (m, size) = (steps.len(), squares[0].len());
        let entry = |row: usize, column: usize| {
            let ((j, r), (i, c)) = ((row / size, row % size), (column / size, column % size));
            latency.follows(i, j) * squares[i][r][c]
        };
        let all = (0..m * size).map(|r| (0..m * size).map(|c| entry(r, c)).collect()).collect();
        growth(all).exp()
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
        let controller = LinearController::from(feedback);
        let of = |&(late, _): &(Latency, f64)| {
            let step = self.split_in_floats(late.part(), self.dt);
            latency.waiting().step(&step, &controller, Some(late.whole() as usize))
        };
        latency.table.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_that_are_none_are_refused_in_words() {
        let refused = |table, hold| RandomLatency::new(table, hold).unwrap_err().to_string();
        assert!(refused(vec![], 0.0).contains("no latencies"));
        assert!(refused(vec![(0.0, 0.5), (2.0, 0.4)], 0.0).contains("sum to 0.9"));
        assert!(refused(vec![(0.0, 1.5), (2.5, -0.5)], 0.0).contains("1.5"));
        assert!(refused(vec![(0.0, 1.0)], f64::NAN).contains("NaN"));
        assert!(refused(vec![(65.0, 1.0)], 0.0).contains("2278 second moments"));
        assert!(refused(vec![(4096.0, 1.0)], 0.0).contains("at most 600"));
        for bad in [-1.0, f64::NAN, 5000.0] {
            assert!(refused(vec![(bad, 1.0)], 0.0).contains(&format!("a latency is {bad} steps")));
        }
    }
}
