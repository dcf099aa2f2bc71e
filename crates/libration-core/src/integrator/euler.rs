//! The three methods of first order that Euler's name covers.
//!
//! Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd ed., §I.1 and §VI.3.

use super::Integrator;
use crate::{Scalar, State, System};

/// Forward Euler, `y' = y + Δt·f(y)`: order 1, unstable for every undamped oscillator.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExplicitEuler;

impl Integrator for ExplicitEuler {
    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        state.plus(dt, system.rate(state))
    }
}

/// Symplectic (semi-implicit) Euler, kick then drift: order 1.
#[derive(Clone, Copy, Debug, Default)]
pub struct SymplecticEuler;

impl Integrator for SymplecticEuler {
    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        state.kick(system, dt).drift(dt)
    }
}

/// Symplectic Euler, drift then kick: the adjoint of [`SymplecticEuler`], order 1.
#[derive(Clone, Copy, Debug, Default)]
pub struct SymplecticEulerDriftFirst;

impl Integrator for SymplecticEulerDriftFirst {
    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        state.drift(dt).kick(system, dt)
    }
}
