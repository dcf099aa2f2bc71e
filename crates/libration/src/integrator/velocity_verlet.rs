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
    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let half = dt.ratio(1, 2);
        state.kick(system, half).drift(dt).kick(system, half)
    }
}
