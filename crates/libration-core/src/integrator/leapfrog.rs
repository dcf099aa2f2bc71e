//! Leapfrog.

use super::Integrator;
use crate::{Scalar, State, System};

/// Leapfrog, drift–kick–drift: order 2, symplectic and time-reversible.
///
/// The mirror image of velocity Verlet (also: position Verlet), with one force evaluation a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leapfrog;

impl Integrator for Leapfrog {
    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let half = dt.ratio(1, 2);
        state.drift(half).kick(system, dt).drift(half)
    }
}
