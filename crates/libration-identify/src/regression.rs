//! Weighted least squares on innovations.

use std::f64::consts::TAU;

use libration::linear::Matrix;

use crate::whitening::{COMMAND, Whitened};

/// A regression on whitened columns.
#[derive(Clone, Debug)]
pub(crate) struct Regression {
    /// Gain, load and initial states; zero for a column that the others explain.
    pub(crate) coefficients: Vec<f64>,
    /// Residuals over the root of their scale.
    pub(crate) residuals: Vec<f64>,
    /// Their sum of squares.
    pub(crate) sum_of_squares: f64,
    /// The sum of the logarithms of the scales.
    pub(crate) log_scales: f64,
    /// How many coefficients were solved for.
    pub(crate) solved: usize,
}

/// A column with less than this part of its square left is explained by the columns before it.
const DEPENDENT: f64 = 1e-11;

impl Regression {
    /// Solves for the coefficients; the gain is known if it is given.
    pub(crate) fn new(whitened: &Whitened, gain: Option<f64>) -> Self {
        let (count, columns) = (whitened.responses.len(), whitened.columns);
        let weights: Vec<f64> = whitened.scales.iter().map(|scale| 1.0 / scale).collect();
        let row = |i: usize| &whitened.regressors[i * columns..(i + 1) * columns];
        let target =
            |i: usize| whitened.responses[i] - gain.map_or(0.0, |gain| gain * row(i)[COMMAND]);
        let mut normal = Matrix::zeros(columns, columns + 1);
        for (i, weight) in weights.iter().enumerate() {
            let (row, target) = (row(i), target(i));
            for a in 0..columns {
                let weighted = weight * row[a];
                for b in a..columns {
                    normal[(a, b)] += weighted * row[b];
                }
                normal[(a, columns)] += weighted * target;
            }
        }
        for a in 0..columns {
            for b in 0..a {
                normal[(a, b)] = normal[(b, a)];
            }
        }
        let is_free = |column: usize| column != COMMAND || gain.is_none();
        let (mut coefficients, solved) = solve_symmetric(&normal, is_free);
        if let Some(gain) = gain {
            coefficients[COMMAND] = gain;
        }
        let mut residuals = Vec::with_capacity(count);
        let (mut sum_of_squares, mut log_scales) = (0.0, 0.0);
        for (i, weight) in weights.iter().enumerate() {
            let mut fit = 0.0;
            for (x, c) in row(i).iter().zip(&coefficients) {
                fit += x * c;
            }
            let residual = (whitened.responses[i] - fit) * weight.sqrt();
            sum_of_squares += residual * residual;
            log_scales += whitened.scales[i].ln();
            residuals.push(residual);
        }
        Regression { sum_of_squares, log_scales, coefficients, residuals, solved }
    }

    /// The variance `σ²` of greatest likelihood.
    pub(crate) fn variance(&self) -> f64 {
        self.sum_of_squares / self.residuals.len() as f64
    }

    /// The greatest log likelihood over the coefficients and `σ²`.
    pub(crate) fn log_likelihood(&self) -> f64 {
        let count = self.residuals.len() as f64;
        // Noise of a rounding, so that a perfect fit has a likelihood.
        let variance = self.variance().max(f64::MIN_POSITIVE);
        -0.5 * (count * ((TAU * variance).ln() + 1.0) + self.log_scales)
    }
}

/// Solves `N x = r`, with `r` in the last column, by elimination in the order of the columns. A dependent unknown is zero.
fn solve_symmetric(normal: &Matrix, is_free: impl Fn(usize) -> bool) -> (Vec<f64>, usize) {
    let n = normal.rows();
    let mut work = normal.clone();
    let mut pivots: Vec<usize> = Vec::new();
    for column in 0..n {
        let left = work[(column, column)];
        if !is_free(column) || left.is_nan() || left <= DEPENDENT * normal[(column, column)] {
            continue;
        }
        for row in 0..n {
            if row == column {
                continue;
            }
            let factor = work[(row, column)] / left;
            if factor != 0.0 {
                for k in 0..=n {
                    let product = factor * work[(column, k)];
                    work[(row, k)] -= product;
                }
            }
        }
        pivots.push(column);
    }
    let mut solution = vec![0.0; n];
    for &column in &pivots {
        solution[column] = work[(column, n)] / work[(column, column)];
    }
    (solution, pivots.len())
}
