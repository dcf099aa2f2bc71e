//! The augmented state of a loop: plant, controller and commands in transit.

use super::LinearController;
use super::dense_matrix::Matrix;
use super::float_step::FloatSplitStep;

/// The augmented state `(q, v, m, u₋₁, u₋₂, …, u)`: the state, the memory of the controller, the commands in transit and, if
/// steps split or commands may be lost, the command that acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct AugmentedState {
    pub(super) memory: usize,
    pub(super) commands: usize,
    pub(super) acting: bool,
}

impl AugmentedState {
    /// The dimension of the augmented state.
    pub(super) fn size(self) -> usize {
        2 + self.memory + self.commands + usize::from(self.acting)
    }

    /// The row of the command that takes over: that of `d` steps ago, or the acting one if the command is lost.
    pub(super) fn arriving(self, controller: &LinearController, d: Option<usize>) -> Vec<f64> {
        let mut row = vec![0.0; self.size()];
        match d {
            Some(0) => controller.command_row(&mut row),
            Some(d) => row[1 + self.memory + d] = 1.0,
            None => row = self.held(),
        }
        row
    }

    /// The row of the command that acts before.
    pub(super) fn held(self) -> Vec<f64> {
        let mut row = vec![0.0; self.size()];
        if let Some(last) = row.last_mut().filter(|_| self.acting) {
            *last = 1.0;
        }
        row
    }

    /// The matrix of a step in which that command takes over.
    pub(super) fn step(
        self,
        step: &FloatSplitStep,
        controller: &LinearController,
        d: Option<usize>,
    ) -> Matrix {
        let n = self.size();
        let FloatSplitStep { phi, old, new } = step;
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
