//! Runge–Kutta methods.

use super::Integrator;
use crate::{Scalar, State, System};

/// The classical Runge–Kutta method: order 4, not symplectic.
///
/// Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, §II.1, table 1.2.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rk4;

impl Integrator for Rk4 {
    // The state and what its four rates sum up to live through all stages.
    const REGISTERS: usize = 16;

    fn evaluations(&self) -> usize {
        4
    }

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let half = dt.ratio(1, 2);
        let k1 = system.rate(state);
        let k2 = system.rate(state.plus(half, k1));
        let k3 = system.rate(state.plus(half, k2));
        let k4 = system.rate(state.plus(dt, k3));
        state.plus(dt.ratio(1, 6), k1 + k2.doubled() + k3.doubled() + k4)
    }
}
