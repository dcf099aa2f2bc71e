//! A period of a loop whose step is drawn.

use crate::deviations::Deviations;
use crate::{Matrix, Stage};

/// The steps that a period may have: their mean, and in which few rows and how far each is off.
pub(crate) struct RandomPeriod {
    pub(crate) mean: Matrix,
    /// Rows in which steps differ.
    pub(crate) rows: Vec<usize>,
    /// The deviations of these rows from the mean.
    off: Deviations,
}

impl RandomPeriod {
    /// The mean and deviations of all possible steps.
    pub(crate) fn new(stages: &[Stage]) -> Self {
        // What all have in common, and to that the mean of what they have not: rows that do not differ are kept bit for bit.
        let mut mean = stages.first().map_or(Matrix::zeros(0, 0), |stage| stage.step.clone());
        let differs = |i: &usize| stages.iter().any(|stage| stage.step.row(*i) != mean.row(*i));
        let rows: Vec<usize> = (0..mean.rows()).filter(differs).collect();
        for &i in &rows {
            for (j, x) in mean.row_mut(i).iter_mut().enumerate() {
                *x = stages.iter().map(|stage| stage.weight * stage.step[(i, j)]).sum();
            }
        }
        let of = |stage: &Stage| {
            Matrix::from_fn(rows.len(), mean.columns(), |k, j| {
                stage.step[(rows[k], j)] - mean[(rows[k], j)]
            })
        };
        let off: Vec<(f64, Matrix)> =
            stages.iter().map(|stage| (stage.weight, of(stage))).collect();
        RandomPeriod { mean, rows, off: Deviations::new(&off) }
    }

    /// `E[Δ P Δᵀ]`.
    pub(crate) fn spread(&self, moments: &Matrix) -> Matrix {
        self.off.spread(moments)
    }

    /// `E[Δ P Δᵀ]`, pair by pair.
    pub(crate) fn seen(&self, moments: &Matrix) -> Vec<f64> {
        let spread = self.spread(moments);
        self.pairs().map(|pair| spread[pair]).collect()
    }

    /// Pairs of rows that are drawn.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let count = self.rows.len();
        (0..count).flat_map(move |a| (a..count).map(move |b| (a, b)))
    }

    /// A unit of the number of a pair, in the rows that are drawn.
    pub(crate) fn unit(&self, (a, b): (usize, usize)) -> Matrix {
        let n = self.mean.rows();
        let (i, j) = (self.rows[a], self.rows[b]);
        let mut unit = Matrix::zeros(n, n);
        (unit[(i, j)], unit[(j, i)]) = (1.0, 1.0);
        unit
    }

    /// `E S Eᵀ`: the numbers of `S` in the rows that are drawn.
    pub(crate) fn placed(&self, spread: &Matrix) -> Matrix {
        let n = self.mean.rows();
        let mut placed = Matrix::zeros(n, n);
        for (a, &i) in self.rows.iter().enumerate() {
            for (b, &j) in self.rows.iter().enumerate() {
                placed[(i, j)] = spread[(a, b)];
            }
        }
        placed
    }
}
