//! Methods that solve nonlinear equations by Newton's iteration.

use super::ImplicitIntegrator;
use crate::array::each;
use crate::system::ImplicitSystem;
use crate::{Scalar, State};

/// Newton steps of [`BackwardEuler`], [`ImplicitMidpoint`], [`Trapezoid`] and the Gauss–Legendre methods, whatever the residual: a step has
/// the same operations for all numbers. [`Iterated`](super::Iterated) measures the residual.
///
/// One is exact on linear systems. The iteration starts from the state (the trapezoid: from its explicit half) and squares its error: on
/// a pendulum that swings by 2 rad, five leave less than a rounding of `f64` at `ωh = 0.5` and 10⁻¹² at `ωh = 1`. Where they do not suffice, the step is another
/// method of the same order.
pub const NEWTON_STEPS: u32 = 5;

/// The `k` with `k = h·f(start + k)`, where `f` is the rate, by so many Newton steps from 0: the first is the linearly implicit step.
///
/// The unknown is the increment and not the state, so that residuals keep their digits.
#[inline(never)]
pub(super) fn increment<S: Scalar, const D: usize>(
    system: &impl ImplicitSystem<S, D>,
    start: State<S, D>,
    h: S,
    newton_steps: u32,
) -> State<S, D> {
    let rate = system.rate(start);
    let right = State { q: each(|i| h * rate.q[i]), v: each(|i| h * rate.v[i]) };
    let mut increment = system.solve_rate(&start, h, right);
    for _ in 1..newton_steps {
        let at = start + increment;
        let rate = system.rate(at);
        let residual = State {
            q: each(|i| h * rate.q[i] - increment.q[i]),
            v: each(|i| h * rate.v[i] - increment.v[i]),
        };
        increment = increment + system.solve_rate(&at, h, residual);
    }
    increment
}

/// [`BackwardEuler`] by so many Newton steps.
pub(super) fn backward_euler<S: Scalar, const D: usize>(
    system: &impl ImplicitSystem<S, D>,
    state: State<S, D>,
    dt: S,
    newton_steps: u32,
) -> State<S, D> {
    state + increment(system, state, dt, newton_steps)
}

/// [`ImplicitMidpoint`] by so many Newton steps.
pub(super) fn implicit_midpoint<S: Scalar, const D: usize>(
    system: &impl ImplicitSystem<S, D>,
    state: State<S, D>,
    dt: S,
    newton_steps: u32,
) -> State<S, D> {
    state + increment(system, state, dt.ratio(1, 2), newton_steps).doubled()
}

/// [`Trapezoid`] by so many Newton steps.
pub(super) fn trapezoid<S: Scalar, const D: usize>(
    system: &impl ImplicitSystem<S, D>,
    state: State<S, D>,
    dt: S,
    newton_steps: u32,
) -> State<S, D> {
    let half = dt.ratio(1, 2);
    let explicit = state.plus(half, system.rate(state));
    explicit + increment(system, explicit, half, newton_steps)
}

/// Backward Euler: `y' = y + h·f(y')` for the state `y` and its rate `f`, by [`NEWTON_STEPS`]. Order 1; stable for every step on every
/// decaying mode, whose energy it takes away.
///
/// Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, 2nd ed., §II.7.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackwardEuler;

impl ImplicitIntegrator for BackwardEuler {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        backward_euler(system, state, dt, NEWTON_STEPS)
    }
}

/// The implicit midpoint rule: `y' = y + h·f((y + y')/2)`, by [`NEWTON_STEPS`]. Order 2; symplectic, time-reversible, stable for every
/// step on every mode that does not grow; it conserves quadratic invariants, such as the energy of an oscillator.
///
/// It is backward Euler to the midpoint, and the same increment again. Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd ed.,
/// §IV.2 and §VI.4.
#[derive(Clone, Copy, Debug, Default)]
pub struct ImplicitMidpoint;

impl ImplicitIntegrator for ImplicitMidpoint {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        implicit_midpoint(system, state, dt, NEWTON_STEPS)
    }
}

/// The trapezoidal rule: `y' = y + h/2·(f(y) + f(y'))`, by [`NEWTON_STEPS`]. Order 2; the same as [`ImplicitMidpoint`] on linear systems,
/// and conjugate to it on others.
///
/// It is half a step of explicit Euler and half a step of backward Euler. Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd
/// ed., §VI.8.
#[derive(Clone, Copy, Debug, Default)]
pub struct Trapezoid;

impl ImplicitIntegrator for Trapezoid {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        trapezoid(system, state, dt, NEWTON_STEPS)
    }
}
