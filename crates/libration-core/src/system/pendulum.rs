//! The mathematical pendulum.

use super::kinetic;
use crate::{Elementary, Hamiltonian, Model, State, System};

/// The pendulum `θ̈ = −ω² sin θ`: a point mass on a rigid, massless rod.
///
/// `q` is the angle from the lower equilibrium in rad, `v` the angular velocity in rad/s. The
/// energy is per `mℓ²`; it is zero at rest and `2ω²` on the separatrix.
///
/// Landau, Lifshitz: Mechanics, 3rd ed., §11, problem 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum<S> {
    /// Squared frequency of small swings `ω² = g/ℓ`, in s⁻².
    pub omega2: S,
}

impl<S: Elementary> System<S, 1> for Pendulum<S> {
    const POSITIONAL: bool = true;

    #[inline(always)]
    fn acceleration(&self, &State { q: [angle], .. }: &State<S, 1>) -> [S; 1] {
        [-self.omega2 * angle.sin()]
    }
}

impl<S: Elementary> Hamiltonian<S, 1> for Pendulum<S> {
    #[inline(always)]
    fn energy(&self, &State { q: [angle], v }: &State<S, 1>) -> S {
        kinetic(&v) + self.omega2 * (S::one() - angle.cos())
    }
}

impl Model<1> for Pendulum<f64> {
    type On<S: Elementary> = Pendulum<S>;
    const LINEAR: bool = false;

    fn on<S: Elementary>(&self) -> Pendulum<S> {
        Pendulum { omega2: S::from_f64(self.omega2) }
    }
}
