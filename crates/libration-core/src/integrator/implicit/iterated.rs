//! Methods with another number of Newton steps.

use super::newton::{backward_euler, implicit_midpoint, trapezoid};
use super::{GaussLegendre4, GaussLegendre6, ImplicitIntegrator, gauss_legendre};
use crate::system::ImplicitSystem;
use crate::{Scalar, State};

/// A method that iterates, with a number of Newton steps in place of [`NEWTON_STEPS`](super::NEWTON_STEPS).
///
/// A step cannot look at its residual, since it has the same operations for all numbers. Beside a run, the difference of a step with one
/// more Newton step is the residual as an error of the state, which bounds the error of an iteration that converges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Iterated {
    /// [`BackwardEuler`](super::BackwardEuler).
    BackwardEuler(u32),
    /// [`ImplicitMidpoint`](super::ImplicitMidpoint).
    ImplicitMidpoint(u32),
    /// [`Trapezoid`](super::Trapezoid).
    Trapezoid(u32),
    /// [`GaussLegendre4`].
    GaussLegendre4(u32),
    /// [`GaussLegendre6`].
    GaussLegendre6(u32),
}

impl ImplicitIntegrator for Iterated {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        match self {
            Iterated::BackwardEuler(count) => backward_euler(system, state, dt, count),
            Iterated::ImplicitMidpoint(count) => implicit_midpoint(system, state, dt, count),
            Iterated::Trapezoid(count) => trapezoid(system, state, dt, count),
            Iterated::GaussLegendre4(count) => {
                gauss_legendre::step(GaussLegendre4, system, state, dt, count)
            }
            Iterated::GaussLegendre6(count) => {
                gauss_legendre::step(GaussLegendre6, system, state, dt, count)
            }
        }
    }
}
