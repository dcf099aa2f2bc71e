//! Methods composed of a simpler method with itself.

use super::dispatch::step_out_of_line;
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

/// Does the same with each weight, written out for the first eight.
///
/// The compiler unrolls only loops that stay short, and a step with a loop in it is no vector in a
/// batch. (A fold is no better: a long closure is called.)
macro_rules! each {
    ($weights:expr, |$weight:ident| $body:block) => {
        each!(@ $weights, $weight, $body, 0 1 2 3 4 5 6 7);
        for $weight in $weights.into_iter().skip(8) $body
    };
    (@ $weights:expr, $weight:ident, $body:block, $($i:literal)*) => {
        $(if const { $i < N } {
            let $weight = $weights[$i];
            $body
        })*
    };
}
pub(super) use each;

impl<I: Integrator, const N: usize> Integrator for Composition<I, N> {
    const CARRIES: bool = I::CARRIES;
    // The weights.
    const REGISTERS: usize = I::REGISTERS + 6;

    fn evaluations(&self) -> usize {
        N * self.base.evaluations()
    }

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let mut state = state;
        each!(self.weights, |weight| {
            state = self.base.step(system, state, dt * S::from_f64(weight));
        });
        state
    }

    /// A loop over the substeps, each of which is called.
    #[inline(always)]
    fn compact_step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let substep =
            |state, weight| step_out_of_line(self.base, system, state, dt * S::from_f64(weight));
        self.weights.into_iter().fold(state, substep)
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
        each!(self.weights, |weight| {
            known = self.base.carried(system, known.0, known.1, dt * S::from_f64(weight));
        });
        known
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Duffing, Oscillator};

    #[test]
    fn all_substeps_are_taken_however_many_there_are() {
        let oscillator = Oscillator { omega2: 2.0 };
        let start = State { q: [1.0], v: [0.5] };
        let weights: [f64; 11] = core::array::from_fn(|i| 0.1 * i as f64 - 0.3);
        let step = Composition { base: VelocityVerlet, weights }.step(&oscillator, start, 0.5);
        let substeps = weights
            .iter()
            .fold(start, |state, weight| VelocityVerlet.step(&oscillator, state, 0.5 * weight));
        assert_eq!(step, substeps);
    }

    #[test]
    fn a_compact_step_gives_the_bits_of_a_step() {
        fn compare(method: impl Integrator) {
            let duffing = Duffing { alpha: -1.3, beta: 0.7 };
            let start = State { q: [1.0], v: [0.5] };
            let wanted = method.step(&duffing, start, 0.3);
            assert_eq!(method.compact_step(&duffing, start, 0.3), wanted);
        }
        compare(YOSHIDA4);
        compare(SUZUKI4);
    }
}
