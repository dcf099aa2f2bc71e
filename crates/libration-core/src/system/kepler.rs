//! The Kepler problem.

use super::kinetic;
use crate::array::map;
use crate::{Elementary, Hamiltonian, Model, State, System};

/// The planar Kepler problem `q̈ = −μ q/|q|³`: a light body about a fixed centre of attraction.
///
/// The force is singular at the origin: a state with `q = 0` has no acceleration that is a number.
///
/// Goldstein, Poole, Safko: Classical Mechanics, 3rd ed., §3.7; Hairer, Lubich, Wanner:
/// Geometric Numerical Integration, 2nd ed., §I.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kepler<S> {
    /// Gravitational parameter `μ = GM`, in m³/s².
    pub mu: S,
}

impl Kepler<f64> {
    /// The start at perihelion, on the positive x axis, of the orbit with semi-major axis 1 and
    /// eccentricity `0 ≤ e < 1`: `q = (1 − e, 0)`, `v = (0, √(μ(1 + e)/(1 − e)))`.
    ///
    /// Outside that range the orbit is not an ellipse and the state may not be a number. One
    /// revolution takes `2π/√μ`.
    pub fn perihelion(&self, eccentricity: f64) -> State<f64, 2> {
        let speed = (self.mu * ((1.0 + eccentricity) / (1.0 - eccentricity))).sqrt();
        State { q: [1.0 - eccentricity, 0.0], v: [0.0, speed] }
    }
}

/// `1/|q|`.
#[inline(always)]
fn inverse_distance<S: Elementary>([x, y]: [S; 2]) -> S {
    (x * x + y * y).sqrt().recip()
}

impl<S: Elementary> System<S, 2> for Kepler<S> {
    const POSITIONAL: bool = true;

    #[inline(always)]
    fn acceleration(&self, &State { q, .. }: &State<S, 2>) -> [S; 2] {
        let inverse = inverse_distance(q);
        let pull = -self.mu * (inverse * inverse * inverse);
        map(q, |q| pull * q)
    }
}

impl<S: Elementary> Hamiltonian<S, 2> for Kepler<S> {
    #[inline(always)]
    fn energy(&self, &State { q, v }: &State<S, 2>) -> S {
        kinetic(&v) - self.mu * inverse_distance(q)
    }
}

impl Model<2> for Kepler<f64> {
    type On<S: Elementary> = Kepler<S>;
    const LINEAR: bool = false;

    fn on<S: Elementary>(&self) -> Kepler<S> {
        Kepler { mu: S::from_f64(self.mu) }
    }
}
