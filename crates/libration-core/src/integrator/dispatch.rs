//! Dispatch of a method that is known at run time.

use super::{Integrator, WithIntegrator};
use crate::{Method, Scalar, State, System, with_method};

/// Dispatches each step to the method, with the same bits. Code that takes any method is then compiled once; fast loops use
/// [`with_method!`].
impl Integrator for Method {
    const DISPATCHES: bool = true;

    #[inline(always)]
    fn dispatch<W: WithIntegrator>(self, with: W) -> W::Output {
        with_method!(self, |method| with.integrator(method))
    }

    // Of the one that fills the most.
    const REGISTERS: usize = 16;

    fn evaluations(&self) -> usize {
        with_method!(self, |method| method.evaluations())
    }

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        with_method!(self, |method| step_out_of_line(method, system, state, dt))
    }
}

/// A step in a separate function: nine inlined methods per caller would be slow to compile and need a large stack for exact
/// numbers.
#[inline(never)]
pub(super) fn step_out_of_line<S: Scalar, const D: usize>(
    method: impl Integrator,
    system: &impl System<S, D>,
    state: State<S, D>,
    dt: S,
) -> State<S, D> {
    method.compact_step(system, state, dt)
}
