//! Methods with another number of Newton steps.

use super::newton::{backward_euler, implicit_midpoint, trapezoid};
use super::{GaussLegendre4, GaussLegendre6, ImplicitIntegrator, gauss_legendre};
use crate::system::ImplicitSystem;
use crate::{ImplicitMethod, Scalar, State};

/// An implicit method with another number of Newton steps, by [`ImplicitMethod::refined`].
///
/// A step cannot look at its residual, since it has the same operations for all numbers. Beside a run, the difference of this step from
/// that of the method is the last Newton step, which bounds the error of an iteration that converges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Iterated {
    pub(crate) method: ImplicitMethod,
    pub(crate) newton_steps: u32,
}

impl ImplicitIntegrator for Iterated {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let count = self.newton_steps;
        match self.method {
            ImplicitMethod::BackwardEuler => backward_euler(system, state, dt, count),
            ImplicitMethod::ImplicitMidpoint => implicit_midpoint(system, state, dt, count),
            ImplicitMethod::Trapezoid => trapezoid(system, state, dt, count),
            ImplicitMethod::GaussLegendre4 => {
                gauss_legendre::step(GaussLegendre4, system, state, dt, count)
            }
            ImplicitMethod::GaussLegendre6 => {
                gauss_legendre::step(GaussLegendre6, system, state, dt, count)
            }
            // It solves linear equations, once.
            method => method.step(system, state, dt),
        }
    }
}
