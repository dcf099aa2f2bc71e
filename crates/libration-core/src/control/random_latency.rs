//! Random latencies: a table of latencies and probabilities.

use super::Latency;

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

/// Error of a table of latencies.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LatencyTableError {
    /// The table is empty.
    #[error("the table has no latencies")]
    Empty,
    /// A latency is invalid.
    #[error("a latency is {0} steps; it must be at least 0 and at most {most}", most = Latency::MOST_STEPS)]
    Latency(f64),
    /// The matrix of second moments would be too large.
    #[error(
        "{entries} latencies of up to {longest} steps make {moments} second moments; there may be at most \
         {MOST_MOMENTS}"
    )]
    Size {
        /// The number of entries.
        entries: usize,
        /// The longest of them.
        longest: usize,
        /// The number of second moments.
        moments: usize,
    },
    /// A probability is invalid.
    #[error("a probability is {0}; it must be a number from 0 to 1")]
    Probability(f64),
    /// The probabilities do not sum to 1.
    #[error("the probabilities sum to {0}; they must sum to 1, within 10⁻¹²")]
    Sum(f64),
}

/// Beyond, the powers of the matrix take minutes.
const MOST_MOMENTS: usize = 600;

impl RandomLatency {
    /// Latencies in steps with their probabilities. A latency is redrawn for every step, except with probability `hold`.
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
        let (entries, longest, n) = (latency.table.len(), latency.longest(), latency.step_size());
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

    /// The size of the augmented state: the state, the commands in transit and, if steps split, the acting one.
    pub fn step_size(&self) -> usize {
        2 + self.longest() + usize::from(self.splits_steps())
    }

    /// Whether a command arrives within a step.
    pub fn splits_steps(&self) -> bool {
        self.table.iter().any(|(latency, _)| latency.part() > 0.0)
    }

    /// The probability that entry `next` follows entry `now`.
    pub fn follows(&self, now: usize, next: usize) -> f64 {
        let stays = if now == next { self.hold } else { 0.0 };
        stays + (1.0 - self.hold) * self.table[next].1
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
