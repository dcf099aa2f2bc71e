//! Velocity Verlet.

use super::Integrator;
use crate::{Scalar, State, System};

/// Velocity Verlet, kick–drift–kick: order 2, symplectic and time-reversible.
///
/// Swope, Andersen, Berens, Wilson, J. Chem. Phys. 76, 637 (1982). The rounding errors of this
/// form have no bias; those of [`TextbookVerlet`](super::TextbookVerlet) do.
#[derive(Clone, Copy, Debug, Default)]
pub struct VelocityVerlet;

impl Integrator for VelocityVerlet {
    const CARRIES: bool = true;

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        self.carried(system, state, system.acceleration(&state), dt).0
    }

    #[inline(always)]
    fn carried<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        acceleration: [S; D],
        dt: S,
    ) -> (State<S, D>, [S; D]) {
        let half = dt.ratio(1, 2);
        let state = state.kicked(acceleration, half).drift(dt);
        let acceleration = system.acceleration(&state);
        (state.kicked(acceleration, half), acceleration)
    }
}
