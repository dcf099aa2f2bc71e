//! The map of the covariances of what is drawn, as one of vectors.

use crate::Matrix;
use crate::random_schedule::RandomSchedule;

/// What the covariances `S` of a schedule come back as. A number of `S` is in units of the deviations that an example of `S` has.
pub(crate) struct SpreadMap<'a> {
    schedule: &'a RandomSchedule,
    means: &'a [Matrix],
    /// The deviation of each row that is drawn, by period.
    deviations: Vec<Vec<f64>>,
}

impl<'a> SpreadMap<'a> {
    pub(crate) fn new(
        schedule: &'a RandomSchedule,
        means: &'a [Matrix],
        example: &[Matrix],
    ) -> Self {
        let deviation = |variance: f64| if variance > 0.0 { variance.sqrt() } else { 1.0 };
        let of = |s: &Matrix| (0..s.rows()).map(|i| deviation(s[(i, i)])).collect();
        SpreadMap { schedule, means, deviations: example.iter().map(of).collect() }
    }

    /// The numbers of these covariances.
    pub(crate) fn numbers(&self, spreads: &[Matrix]) -> Vec<f64> {
        let of = |(s, d): (&Matrix, &Vec<f64>)| {
            Matrix::from_fn(s.rows(), s.rows(), |i, j| s[(i, j)] / (d[i] * d[j])).entries().to_vec()
        };
        spreads.iter().zip(&self.deviations).flat_map(of).collect()
    }

    /// The covariances with these numbers.
    pub(crate) fn spreads(&self, mut numbers: &[f64]) -> Vec<Matrix> {
        let of = |d: &Vec<f64>| {
            let n = d.len();
            let (own, rest) = numbers.split_at(n * n);
            numbers = rest;
            Matrix::from_fn(n, n, |i, j| own[i * n + j] * (d[i] * d[j]))
        };
        self.deviations.iter().map(of).collect()
    }

    pub(crate) fn apply(&self, numbers: &[f64]) -> Vec<f64> {
        self.numbers(&self.schedule.returned_spread(self.means, &self.spreads(numbers)))
    }
}
