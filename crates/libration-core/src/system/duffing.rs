//! The Duffing oscillator.

use super::kinetic;
use crate::{Elementary, Hamiltonian, Model, Scalar, State, System};

/// The undamped, undriven Duffing oscillator `q̈ = −αq − βq³`.
///
/// With `α < 0 < β` the potential is a double well with minima at `±√(−α/β)`; with `β < 0` the
/// spring softens, and beyond `√(−α/β)` the motion runs away.
///
/// Guckenheimer, Holmes: Nonlinear Oscillations, Dynamical Systems, and Bifurcations of Vector
/// Fields, §2.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duffing<S> {
    /// Linear stiffness per unit mass `α`, in s⁻²; negative for a double well.
    pub alpha: S,
    /// Cubic stiffness per unit mass `β`, in m⁻² s⁻².
    pub beta: S,
}

impl<S: Scalar> System<S, 1> for Duffing<S> {
    const POSITIONAL: bool = true;
    const REGISTERS: usize = 6;

    #[inline(always)]
    fn acceleration(&self, &State { q: [q], .. }: &State<S, 1>) -> [S; 1] {
        [-self.alpha * q - self.beta * (q * q * q)]
    }
}

impl<S: Scalar> Hamiltonian<S, 1> for Duffing<S> {
    #[inline(always)]
    fn energy(&self, &State { q: [q], v }: &State<S, 1>) -> S {
        let square = q * q;
        kinetic(&v)
            + (self.alpha * square).ratio(1, 2)
            + (self.beta * (square * square)).ratio(1, 4)
    }
}

impl Model<1> for Duffing<f64> {
    type On<S: Elementary> = Duffing<S>;
    const LINEAR: bool = false;

    fn on<S: Elementary>(&self) -> Duffing<S> {
        Duffing { alpha: S::from_f64(self.alpha), beta: S::from_f64(self.beta) }
    }
}
