//! One step on the oscillator as a matrix of exact polynomials.

use super::UpdateMatrix;
use crate::number::Poly;
use crate::system::Oscillator;
use crate::{Integrator, Scalar};

/// Polynomials in the unknown `z = ωΔt`. Thirty-two coefficients hold the determinant of a
/// composition of three Verlet steps with room to spare.
pub type UnknownStep = Poly<32>;

/// The update matrix of an integrator on the oscillator with `ω = 1`, exact in `z = ωΔt`.
///
/// For another `ω` the entry that maps `v` to `q` is divided by `ω`, the one that maps `q` to `v`
/// multiplied by it; trace and determinant are the same.
#[derive(Clone, Copy, Debug)]
pub struct SymbolicStep {
    /// The update matrix.
    pub matrix: UpdateMatrix<UnknownStep, 1>,
}

impl SymbolicStep {
    /// Runs one step of `integrator` on polynomials; none if they outgrow their exact arithmetic.
    pub fn new(integrator: impl Integrator) -> Option<Self> {
        let oscillator = Oscillator { omega2: UnknownStep::one() };
        let z = UnknownStep::unknown();
        let matrix = UpdateMatrix::from_map(|e| integrator.step(&oscillator, e, z));
        let valid = matrix.rows().iter().flatten().all(UnknownStep::is_valid);
        let symbolic = SymbolicStep { matrix };
        (valid && symbolic.determinant().is_valid()).then_some(symbolic)
    }

    /// `λ₁ + λ₂` as a polynomial in `z`.
    pub fn trace(&self) -> UnknownStep {
        self.matrix.trace()
    }

    /// `λ₁ · λ₂` as a polynomial in `z`.
    pub fn determinant(&self) -> UnknownStep {
        self.matrix.determinant()
    }
}
