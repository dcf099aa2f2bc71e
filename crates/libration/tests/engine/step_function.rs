//! A step behind a pointer: what runs it is compiled once, and not once for each method and system.

use libration::{Integrator, Method, Scalar, State, System, with_method};

/// What a step makes of a state.
pub(crate) type StepFunction<'a, S, const D: usize> = Box<dyn Fn(State<S, D>) -> State<S, D> + 'a>;

/// The step of `method`, as fast loops take it.
pub(crate) fn step_function<'a, S: Scalar + 'a, const D: usize>(
    method: Method,
    system: impl System<S, D> + 'a,
    dt: S,
) -> StepFunction<'a, S, D> {
    with_method!(method, |method| Box::new(move |state| method.step(&system, state, dt)))
}
