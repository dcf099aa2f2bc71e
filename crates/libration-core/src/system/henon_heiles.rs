//! The Hénon–Heiles system.

use super::kinetic;
use crate::{Elementary, Hamiltonian, Model, Scalar, State, System};

/// The Hénon–Heiles system: `ẍ = −x − 2λxy`, `ÿ = −y − λ(x² − y²)`, in reduced units.
///
/// It is the simplest model of a star in a galaxy's meridian plane. The potential is
/// `½(x² + y²) + λ(x²y − y³/3)`. Orbits are bounded below the energy `1/(6λ²)`; regular and
/// chaotic ones coexist, and chaos prevails as that energy is approached.
///
/// Hénon, Heiles, Astron. J. 69, 73 (1964), with `λ = 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenonHeiles<S> {
    /// Strength `λ` of the cubic coupling, dimensionless.
    pub lambda: S,
}

impl Default for HenonHeiles<f64> {
    fn default() -> Self {
        HenonHeiles { lambda: 1.0 }
    }
}

impl<S: Scalar> System<S, 2> for HenonHeiles<S> {
    const POSITIONAL: bool = true;

    #[inline(always)]
    fn acceleration(&self, &State { q: [x, y], .. }: &State<S, 2>) -> [S; 2] {
        let xy = x * y;
        [-x - self.lambda * (xy + xy), -y - self.lambda * (x * x - y * y)]
    }
}

impl<S: Scalar> Hamiltonian<S, 2> for HenonHeiles<S> {
    #[inline(always)]
    fn energy(&self, &State { q: [x, y], v }: &State<S, 2>) -> S {
        let harmonic = (x * x + y * y).ratio(1, 2);
        let cubic = x * x * y - (y * y * y).ratio(1, 3);
        kinetic(&v) + harmonic + self.lambda * cubic
    }
}

impl Model<2> for HenonHeiles<f64> {
    type On<S: Elementary> = HenonHeiles<S>;
    const LINEAR: bool = false;

    fn on<S: Elementary>(&self) -> HenonHeiles<S> {
        HenonHeiles { lambda: S::from_f64(self.lambda) }
    }
}
