//! The harmonic oscillator.

use super::kinetic;
use crate::array::each;
use crate::{Elementary, Hamiltonian, Model, Scalar, State, System};

/// The isotropic harmonic oscillator `q̈ = −ω²q` in any number of dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator<S> {
    /// Squared natural frequency `ω² = k/m`, in s⁻².
    pub omega2: S,
}

impl Oscillator<f64> {
    /// The oscillator of a mass `m` (kg) on a spring of stiffness `k` (N/m).
    pub fn from_mass_and_stiffness(m: f64, k: f64) -> Self {
        Oscillator { omega2: k / m }
    }
}

impl<S: Scalar> Oscillator<S> {
    /// The energy per unit mass at `q` and `v`, of which there are as many.
    #[inline(always)]
    pub fn energy_of(&self, q: &[S], v: &[S]) -> S {
        let square = q.iter().fold(S::zero(), |sum, &q| sum + q * q);
        kinetic(v) + (self.omega2 * square).ratio(1, 2)
    }
}

impl<S: Scalar, const D: usize> System<S, D> for Oscillator<S> {
    const POSITIONAL: bool = true;
    const REGISTERS: usize = 2;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        each(|i| -self.omega2 * state.q[i])
    }
}

impl<S: Scalar, const D: usize> Hamiltonian<S, D> for Oscillator<S> {
    #[inline(always)]
    fn energy(&self, state: &State<S, D>) -> S {
        self.energy_of(&state.q, &state.v)
    }
}

impl<const D: usize> Model<D> for Oscillator<f64> {
    type On<S: Elementary> = Oscillator<S>;
    const LINEAR: bool = true;

    fn on<S: Elementary>(&self) -> Oscillator<S> {
        Oscillator { omega2: S::from_f64(self.omega2) }
    }
}
