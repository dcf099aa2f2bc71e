//! Dispatch of a method that is known at run time.

use super::{Integrator, WithIntegrator};
use crate::{Method, Scalar, State, System, with_method};

/// The same bits as the method itself. Each step begins with a choice, so that code which takes any method is
/// compiled once: for loops that are to be fast there is [`with_method!`].
impl Integrator for Method {
    const DISPATCHES: bool = true;

    #[inline(always)]
    fn dispatch<W: WithIntegrator>(self, with: W) -> W::Output {
        with_method!(self, |method| with.integrator(method))
    }

    // Of the one that fills the most.
    const REGISTERS: usize = 16;

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

/// A step that is a function of its own: nine of them in every caller would take long to compile, and a stack that holds
/// the exact numbers of all.
#[inline(never)]
fn step_out_of_line<S: Scalar, const D: usize>(
    method: impl Integrator,
    system: &impl System<S, D>,
    state: State<S, D>,
    dt: S,
) -> State<S, D> {
    method.step(system, state, dt)
}
