//! Systems under a held command.

use super::System;
use crate::array::each;
use crate::{Scalar, State};

/// `q̈ = a(q, v) + u`: a system with a command `u` that is held while a step lasts, as a zero-order hold does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandedSystem<Sys, S, const D: usize> {
    /// The system without command.
    pub system: Sys,
    /// The command: an acceleration in each degree of freedom.
    pub command: [S; D],
}

impl<Sys: System<S, D>, S: Scalar, const D: usize> System<S, D> for CommandedSystem<Sys, S, D> {
    const POSITIONAL: bool = Sys::POSITIONAL;
    const REGISTERS: usize = Sys::REGISTERS + D;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        let own = self.system.acceleration(state);
        each(|i| own[i] + self.command[i])
    }
}
