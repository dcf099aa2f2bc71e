//! Methods given as a word of kicks and drifts.

use super::Integrator;
use super::composition::each;
use crate::{Scalar, State, System};

/// A splitting method: in each of `N` stages a kick, then a drift, each for its fraction of `dt`.
///
/// `OrderCertificate` computes the order for any weights.
#[derive(Clone, Copy, Debug)]
pub struct Splitting<const N: usize> {
    /// Fractions of `dt` for which the force acts; they sum to one.
    pub kicks: [f64; N],
    /// Fractions of `dt` for which the velocity acts, each after its kick; they sum to one.
    pub drifts: [f64; N],
}

impl<const N: usize> Integrator for Splitting<N> {
    // A step of symplectic Euler, and the weights.
    const REGISTERS: usize = 10;

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let mut stages = [[0.0; 2]; N];
        for (stage, (kick, drift)) in stages.iter_mut().zip(self.kicks.iter().zip(&self.drifts)) {
            *stage = [*kick, *drift];
        }
        let mut state = state;
        each!(stages, |stage| {
            let [kick, drift] = stage;
            state = state.kick(system, dt * S::from_f64(kick)).drift(dt * S::from_f64(drift));
        });
        state
    }
}
