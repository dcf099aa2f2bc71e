//! Steps of a plant under held commands.

use crate::{Matrix, exponential};

/// `x' = Φx + Γu`: a step, or a part of one, under a command `u` that is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Discretisation {
    /// `Φ`, states × states.
    pub phi: Matrix,
    /// `Γ`, states × commands.
    pub gamma: Matrix,
}

impl Discretisation {
    /// The exact step of `h` seconds of `ẋ = Ax + Bu`.
    ///
    /// Commands are coordinates that do not change: the exponential of the larger matrix holds both `Φ` and `Γ` (C. F. Van Loan,
    /// *Computing integrals involving the matrix exponential*, IEEE Transactions on Automatic Control 23, 1978).
    pub fn exact(a: &Matrix, b: &Matrix, h: f64) -> Self {
        let (n, m) = (a.rows(), b.columns());
        let mut all = Matrix::zeros(n + m, n + m);
        all.set_block((0, 0), &a.scaled(h));
        all.set_block((0, n), &b.scaled(h));
        let power = exponential(&all);
        Discretisation { phi: power.block((0, 0), (n, n)), gamma: power.block((0, n), (n, m)) }
    }

    /// This step and then another, under the same command.
    pub fn then(&self, next: &Discretisation) -> Self {
        let gamma = (&next.phi * &self.gamma).plus(&next.gamma);
        Discretisation { phi: &next.phi * &self.phi, gamma }
    }
}
