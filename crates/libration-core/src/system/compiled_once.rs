//! Systems whose batches are compiled once.

use super::{Hamiltonian, System};
use crate::{Scalar, State};

/// A system whose batches are compiled for the baseline of the architecture alone: the same bits in a third of the code, for
/// what runs too shortly to gain from wide vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompiledOnce<Sys>(
    /// The system.
    pub Sys,
);

impl<S: Scalar, Sys: System<S, D>, const D: usize> System<S, D> for CompiledOnce<Sys> {
    const POSITIONAL: bool = Sys::POSITIONAL;
    const REGISTERS: usize = Sys::REGISTERS;
    const COMPILED_ONCE: bool = true;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        self.0.acceleration(state)
    }
}

impl<S: Scalar, Sys: Hamiltonian<S, D>, const D: usize> Hamiltonian<S, D> for CompiledOnce<Sys> {
    #[inline(always)]
    fn energy(&self, state: &State<S, D>) -> S {
        self.0.energy(state)
    }
}
