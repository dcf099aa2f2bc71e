//! Systems whose batches are compiled for one instruction set.

use super::{Hamiltonian, System};
use crate::{Scalar, State};

/// A system whose batches are compiled for the baseline of the architecture alone: the same bits in a third of the code, for
/// callers in which compile time matters more than wide vectors. Wrap the whole system: inside another one the constant has no
/// effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaselineOnly<Sys>(
    /// The system.
    pub Sys,
);

impl<S: Scalar, Sys: System<S, D>, const D: usize> System<S, D> for BaselineOnly<Sys> {
    const POSITIONAL: bool = Sys::POSITIONAL;
    const REGISTERS: usize = Sys::REGISTERS;
    const BASELINE_ONLY: bool = true;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        self.0.acceleration(state)
    }
}

impl<S: Scalar, Sys: Hamiltonian<S, D>, const D: usize> Hamiltonian<S, D> for BaselineOnly<Sys> {
    #[inline(always)]
    fn energy(&self, state: &State<S, D>) -> S {
        self.0.energy(state)
    }
}
