//! The driven, damped harmonic oscillator.

use super::kinetic;
use crate::{Elementary, Hamiltonian, Model, State, System};

/// The oscillator under a periodic force, `q̈ = −ω²q − γv + F cos(Ωt)`.
///
/// Time is the second coordinate: `q = (q, t)` and `v = (v, 1)`. A start must therefore have
/// `v[1] = 1`; `q[1]` sets the phase of the drive.
///
/// As with [`DampedOscillator`](super::DampedOscillator), splitting methods fall to order 1
/// where `γ ≠ 0`.
///
/// Landau, Lifshitz: Mechanics, 3rd ed., §26.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenOscillator<S> {
    /// Squared natural frequency `ω² = k/m`, in s⁻².
    pub omega2: S,
    /// Damping rate `γ = c/m`, in s⁻¹.
    pub gamma: S,
    /// Amplitude `F` of the drive: force per unit mass, in m/s².
    pub amplitude: S,
    /// Angular frequency `Ω` of the drive, in rad/s.
    pub drive: S,
}

impl<S: Elementary> System<S, 2> for DrivenOscillator<S> {
    #[inline(always)]
    fn acceleration(&self, &State { q: [q, t], v: [v, _] }: &State<S, 2>) -> [S; 2] {
        let force = self.amplitude * (self.drive * t).cos();
        [-self.omega2 * q - self.gamma * v + force, S::zero()]
    }
}

/// The oscillator's own energy, without the coordinate of time. It is not conserved: the drive
/// does the work `F cos(Ωt)·v` on it and damping takes `γv²` away.
impl<S: Elementary> Hamiltonian<S, 2> for DrivenOscillator<S> {
    #[inline(always)]
    fn energy(&self, &State { q: [q, _], v: [v, _] }: &State<S, 2>) -> S {
        kinetic(&[v]) + (self.omega2 * (q * q)).ratio(1, 2)
    }
}

impl Model<2> for DrivenOscillator<f64> {
    type On<S: Elementary> = DrivenOscillator<S>;
    const LINEAR: bool = false;

    fn on<S: Elementary>(&self) -> DrivenOscillator<S> {
        DrivenOscillator {
            omega2: S::from_f64(self.omega2),
            gamma: S::from_f64(self.gamma),
            amplitude: S::from_f64(self.amplitude),
            drive: S::from_f64(self.drive),
        }
    }
}
