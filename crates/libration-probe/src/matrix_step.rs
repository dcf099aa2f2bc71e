//! Matrices of a step as a black box.

use libration::linear::Matrix;

use crate::{BlackBox, BlackBoxError};

/// A step `x' = A x + B u` of one length.
#[derive(Clone, Debug)]
pub struct MatrixStep {
    /// States × states.
    pub a: Matrix,
    /// States × inputs.
    pub b: Matrix,
}

impl BlackBox for MatrixStep {
    fn step(
        &mut self,
        states: &Matrix,
        actions: &Matrix,
        _dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        let of_states = states * &self.a.transposed();
        Ok(of_states.plus(&(actions * &self.b.transposed())))
    }

    fn is_batched(&self) -> bool {
        true
    }
}
