//! Methods composed of a simpler method with itself.

use super::{Integrator, VelocityVerlet};
use crate::{Scalar, State, System};

/// A method repeated within one step, with substeps that are fractions of `dt`.
///
/// With a symmetric base and palindromic weights the order rises: Hairer, Lubich, Wanner:
/// Geometric Numerical Integration, 2nd ed., §II.4 and §V.3.
#[derive(Clone, Copy, Debug)]
pub struct Composition<I, const N: usize> {
    /// The method that is composed.
    pub base: I,
    /// The fraction of `dt` that each substep takes; they sum to one.
    pub weights: [f64; N],
}

/// The type of [`YOSHIDA4`].
pub type Yoshida4 = Composition<VelocityVerlet, 3>;

/// Yoshida's composition of velocity Verlet: order 4, symplectic and time-reversible.
///
/// The weights are `w₁ = 1/(2 − ∛2)` and `w₀ = 1 − 2w₁`: Yoshida, Phys. Lett. A 150, 262 (1990).
/// In `f64` they are what these formulas give, operation by operation; their sum is exactly one.
pub const YOSHIDA4: Yoshida4 = Composition {
    base: VelocityVerlet,
    weights: [1.351_207_191_959_657_8, -1.702_414_383_919_315_5, 1.351_207_191_959_657_8],
};

/// The type of [`SUZUKI4`].
pub type Suzuki4 = Composition<VelocityVerlet, 5>;

/// Suzuki's composition of velocity Verlet: order 4, symplectic and time-reversible, with an error
/// far below that of [`YOSHIDA4`] and a longer, interrupted range of stable steps.
///
/// The weights are `p = 1/(4 − ∛4)`, four times, and `1 − 4p` in the middle: Suzuki, Phys. Lett. A
/// 146, 319 (1990). In `f64` they are what these formulas give, operation by operation.
pub const SUZUKI4: Suzuki4 = Composition {
    base: VelocityVerlet,
    weights: [
        0.414_490_771_794_375_7,
        0.414_490_771_794_375_7,
        -0.657_963_087_177_502_8,
        0.414_490_771_794_375_7,
        0.414_490_771_794_375_7,
    ],
};

impl<I: Integrator, const N: usize> Integrator for Composition<I, N> {
    const CARRIES: bool = I::CARRIES;

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        // A loop and not a fold: a long closure is called, and a call in a batch is no vector.
        let mut state = state;
        for weight in self.weights {
            state = self.base.step(system, state, dt * S::from_f64(weight));
        }
        state
    }

    #[inline(always)]
    fn carried<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        acceleration: [S; D],
        dt: S,
    ) -> (State<S, D>, [S; D]) {
        let mut known = (state, acceleration);
        for weight in self.weights {
            known = self.base.carried(system, known.0, known.1, dt * S::from_f64(weight));
        }
        known
    }
}
