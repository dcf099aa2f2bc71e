//! A system about an operating point, where a constant command holds it.

use core::array::from_fn;

use libration::{Elementary, Hamiltonian, Model, Scalar, State, System};

/// `a(q + q₀, v) − a(q₀, 0)`: what moves about `q₀`, with the command that holds it there taken off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct About<M, const D: usize> {
    pub(super) model: M,
    pub(super) at: [f64; D],
}

/// [`About`] on numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moved<Sys, S, const D: usize> {
    system: Sys,
    at: [S; D],
    held: [S; D],
}

impl<Sys, S: Scalar, const D: usize> Moved<Sys, S, D> {
    fn place(&self, state: &State<S, D>) -> State<S, D> {
        State { q: from_fn(|i| state.q[i] + self.at[i]), v: state.v }
    }
}

impl<Sys: System<S, D>, S: Scalar, const D: usize> System<S, D> for Moved<Sys, S, D> {
    const POSITIONAL: bool = Sys::POSITIONAL;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        let own = self.system.acceleration(&self.place(state));
        from_fn(|i| own[i] - self.held[i])
    }
}

impl<Sys: Hamiltonian<S, D>, S: Scalar, const D: usize> Hamiltonian<S, D> for Moved<Sys, S, D> {
    fn energy(&self, state: &State<S, D>) -> S {
        self.system.energy(&self.place(state))
    }
}

impl<M: Model<D>, const D: usize> Model<D> for About<M, D> {
    type On<S: Elementary> = Moved<M::On<S>, S, D>;
    const LINEAR: bool = M::LINEAR;

    fn on<S: Elementary>(&self) -> Self::On<S> {
        let (system, at) = (self.model.on::<S>(), self.at.map(S::from_f64));
        let rest = State { q: at, v: [S::zero(); D] };
        Moved { system, at, held: system.acceleration(&rest) }
    }
}
