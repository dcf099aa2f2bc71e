//! The damped harmonic oscillator.

use super::kinetic;
use crate::{Elementary, Hamiltonian, Model, Scalar, State, System};

/// The oscillator with viscous damping, `q̈ = −ω²q − γv`, in one dimension.
///
/// One dimension suffices: an isotropic damped oscillator is independent copies of this one.
///
/// The force depends on the velocity, so a kick is no longer the exact flow of a part of the
/// system: for `γ ≠ 0` the splitting methods, velocity Verlet and Yoshida among them, fall to
/// order 1. RK4 keeps its order.
///
/// Landau, Lifshitz: Mechanics, 3rd ed., §25 (there `γ = 2λ`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedOscillator<S> {
    /// Squared natural frequency `ω² = k/m` of the undamped oscillator, in s⁻².
    pub omega2: S,
    /// Damping rate `γ = c/m`, in s⁻¹; critical at `γ = 2ω`.
    pub gamma: S,
}

impl<S: Scalar> System<S, 1> for DampedOscillator<S> {
    const REGISTERS: usize = 6;

    #[inline(always)]
    fn acceleration(&self, &State { q: [q], v: [v] }: &State<S, 1>) -> [S; 1] {
        [-self.omega2 * q - self.gamma * v]
    }
}

/// The energy of the undamped oscillator; it falls at the rate `γv²`.
impl<S: Scalar> Hamiltonian<S, 1> for DampedOscillator<S> {
    #[inline(always)]
    fn energy(&self, &State { q: [q], v }: &State<S, 1>) -> S {
        kinetic(&v) + (self.omega2 * (q * q)).ratio(1, 2)
    }
}

impl Model<1> for DampedOscillator<f64> {
    type On<S: Elementary> = DampedOscillator<S>;
    const LINEAR: bool = true;

    fn on<S: Elementary>(&self) -> DampedOscillator<S> {
        DampedOscillator { omega2: S::from_f64(self.omega2), gamma: S::from_f64(self.gamma) }
    }
}
