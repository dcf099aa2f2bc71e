//! Systems relative to an operating point that a constant command holds.

use libration::{Elementary, Hamiltonian, Model, Scalar, State, System};

/// A model relative to the operating point `q₀`, with acceleration `a(q + q₀, v) − a(q₀, 0)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ModelAtOperatingPoint<M, const D: usize> {
    pub(super) model: M,
    pub(super) at: [f64; D],
}

/// The system of [`ModelAtOperatingPoint`] on a number type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SystemAtOperatingPoint<Sys, S, const D: usize> {
    system: Sys,
    at: [S; D],
    held: [S; D],
}

impl<Sys, S: Scalar, const D: usize> SystemAtOperatingPoint<Sys, S, D> {
    #[inline(always)]
    fn place(&self, state: &State<S, D>) -> State<S, D> {
        let mut placed = *state;
        for i in 0..D {
            placed.q[i] = state.q[i] + self.at[i];
        }
        placed
    }
}

impl<Sys: System<S, D>, S: Scalar, const D: usize> System<S, D>
    for SystemAtOperatingPoint<Sys, S, D>
{
    const POSITIONAL: bool = Sys::POSITIONAL;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        let mut acceleration = self.system.acceleration(&self.place(state));
        for (own, held) in acceleration.iter_mut().zip(&self.held) {
            *own = *own - *held;
        }
        acceleration
    }
}

impl<Sys: Hamiltonian<S, D>, S: Scalar, const D: usize> Hamiltonian<S, D>
    for SystemAtOperatingPoint<Sys, S, D>
{
    fn energy(&self, state: &State<S, D>) -> S {
        self.system.energy(&self.place(state))
    }
}

impl<M: Model<D>, const D: usize> Model<D> for ModelAtOperatingPoint<M, D> {
    type On<S: Elementary> = SystemAtOperatingPoint<M::On<S>, S, D>;
    const LINEAR: bool = M::LINEAR;

    fn on<S: Elementary>(&self) -> Self::On<S> {
        let (system, at) = (self.model.on::<S>(), self.at.map(S::from_f64));
        let rest = State { q: at, v: [S::zero(); D] };
        SystemAtOperatingPoint { system, at, held: system.acceleration(&rest) }
    }
}
