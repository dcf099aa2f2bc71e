//! Methods that solve equations in each step, each defined exactly once.
//!
//! A method is written over the derivatives and the linear solutions of an [`ImplicitSystem`], with the numbers of any
//! [`Scalar`](crate::Scalar): on floats it simulates, on recorded numbers it becomes a program, on quotients of polynomials it yields its
//! own update matrix. `h` is the time step, `a(q, v)` the acceleration.

mod gauss_legendre;
#[cfg(test)]
mod gauss_legendre_tests;
mod iterated;
mod linearly_implicit;
mod newton;
#[cfg(test)]
mod tests;

use crate::system::ImplicitSystem;
use crate::{Scalar, State};

pub use gauss_legendre::{GaussLegendre4, GaussLegendre6};
pub use iterated::Iterated;
pub use linearly_implicit::{DampingImplicit, DampingStiffnessImplicit, StablePd};
pub use newton::{BackwardEuler, ImplicitMidpoint, NEWTON_STEPS, Trapezoid};

/// A one-step method `(q, v) ↦ (q', v')` that solves equations of its system.
///
/// A step never fails, allocates, branches on data or reads a clock: it solves a fixed number of linear equations by a fixed number of
/// operations.
pub trait ImplicitIntegrator: Copy + Send + Sync {
    /// Advances `state` by one step of length `dt`.
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D>;
}
