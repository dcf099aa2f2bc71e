//! Counts of force evaluations.

use core::cell::Cell;

use crate::{Hamiltonian, Scalar, State, System};

/// A system that counts how often its acceleration is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct CountedSystem<'a, Sys> {
    system: Sys,
    count: &'a Cell<u64>,
}

impl<'a, Sys> CountedSystem<'a, Sys> {
    /// `system`, its evaluations added to `count`.
    pub fn new(system: Sys, count: &'a Cell<u64>) -> Self {
        CountedSystem { system, count }
    }
}

impl<S: Scalar, Sys: System<S, D>, const D: usize> System<S, D> for CountedSystem<'_, Sys> {
    const POSITIONAL: bool = Sys::POSITIONAL;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        self.count.set(self.count.get() + 1);
        self.system.acceleration(state)
    }
}

impl<S: Scalar, Sys: Hamiltonian<S, D>, const D: usize> Hamiltonian<S, D>
    for CountedSystem<'_, Sys>
{
    #[inline(always)]
    fn energy(&self, state: &State<S, D>) -> S {
        self.system.energy(state)
    }
}
