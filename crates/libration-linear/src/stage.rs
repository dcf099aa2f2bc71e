//! One possible period of a loop.

use crate::{Matrix, symmetric_square};

/// One possible period of a loop, with its probability.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The probability.
    pub weight: f64,
    /// The matrix on the state of the loop.
    pub step: Matrix,
    /// The covariance of what noise adds to the state of the loop.
    pub noise: Matrix,
    /// The cost as a quadratic form of the state of the loop at the beginning of the period.
    pub cost: Matrix,
    /// The constant part of the cost.
    pub constant: f64,
    /// The length by which the cost is divided: seconds, or 1 per period.
    pub length: f64,
}

impl Stage {
    /// The covariance of what noise adds in a period, over all stages.
    pub fn mean_noise(stages: &[Stage]) -> Matrix {
        let n = stages.first().map_or(0, |stage| stage.step.rows());
        let mut noise = Matrix::zeros(n, n);
        for stage in stages {
            noise.add_scaled(stage.weight, &stage.noise);
        }
        noise
    }

    /// The expected cost for these second moments at the beginning of the period.
    pub fn expected(&self, moments: &Matrix) -> f64 {
        self.cost.inner(moments) + self.constant
    }
}

/// `E[M ⊗ M]` on symmetric matrices.
pub fn mean_square(stages: &[Stage]) -> Matrix {
    let mut squares = stages.iter().map(|stage| (stage.weight, symmetric_square(&stage.step)));
    let Some((weight, first)) = squares.next() else { return Matrix::zeros(0, 0) };
    squares.fold(first.scaled(weight), |mut mean, (weight, square)| {
        mean.add_scaled(weight, &square);
        mean
    })
}
