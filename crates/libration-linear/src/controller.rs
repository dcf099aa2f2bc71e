//! Discrete controllers in state space.

use crate::Matrix;

/// `m' = A·m + B·y` and `u = C·m + D·y`: a controller with memory `m`, measurements `y` and commands `u`, once per period.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscreteController {
    /// Memory × memory.
    pub a: Matrix,
    /// Memory × measurements.
    pub b: Matrix,
    /// Commands × memory.
    pub c: Matrix,
    /// Commands × measurements.
    pub d: Matrix,
}

impl DiscreteController {
    /// `u = D·y`, without memory.
    pub fn gain(d: Matrix) -> Self {
        let (commands, measurements) = (d.rows(), d.columns());
        let [a, b] = [Matrix::zeros(0, 0), Matrix::zeros(0, measurements)];
        DiscreteController { a, b, c: Matrix::zeros(commands, 0), d }
    }

    /// The size of the memory.
    pub fn memory(&self) -> usize {
        self.a.rows()
    }

    /// The number of measurements.
    pub fn measurements(&self) -> usize {
        self.d.columns()
    }

    /// The number of commands.
    pub fn commands(&self) -> usize {
        self.d.rows()
    }

    /// The controller with its commands times `factor`.
    pub fn amplified(&self, factor: f64) -> Self {
        let [c, d] = [&self.c, &self.d].map(|m| m.scaled(factor));
        DiscreteController { c, d, ..self.clone() }
    }
}
