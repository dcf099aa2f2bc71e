//! One step on a linear system as a matrix of exact polynomials.

use libration_core::number::Poly;
use libration_core::system::Oscillator;
use libration_core::{Integrator, Scalar, System};

use super::{QuadraticForm, UpdateMatrix};

/// Polynomials in the unknown `z = ωΔt`. Thirty-two coefficients hold the determinant of a
/// composition of three Verlet steps with room to spare.
pub type UnknownStep = Poly<32>;

/// The update matrix of an integrator on a linear system, exact in the time step.
///
/// [`SymbolicStep::new`] takes the oscillator with `ω = 1`, for which the unknown is `z = ωΔt`. For
/// another `ω` the entry that maps `v` to `q` is divided by `ω`, the one that maps `q` to `v`
/// multiplied by it; trace and determinant are the same.
#[derive(Clone, Copy, Debug)]
pub struct SymbolicStep {
    /// The update matrix.
    pub matrix: UpdateMatrix<UnknownStep>,
}

impl SymbolicStep {
    /// One step of `integrator` on the oscillator with `ω = 1`; none if the polynomials outgrow
    /// their exact arithmetic.
    pub fn new(integrator: impl Integrator) -> Option<Self> {
        SymbolicStep::of(integrator, &Oscillator { omega2: UnknownStep::one() })
            .filter(|step| step.determinant().is_valid())
    }

    /// One step of `integrator` on a linear system, in powers of `Δt`; none if the system is not
    /// linear, or the entries of the matrix outgrow their exact arithmetic. The determinant, which has twice as many digits, may
    /// be undefined; [`SymbolicStep::stability_windows`] are known also then.
    pub fn of(integrator: impl Integrator, system: &impl System<UnknownStep, 1>) -> Option<Self> {
        let dt = UnknownStep::unknown();
        let matrix = UpdateMatrix::from_map(|e| integrator.step(system, e, dt));
        let valid = matrix.rows().iter().flatten().all(UnknownStep::is_valid);
        valid.then_some(SymbolicStep { matrix })
    }

    /// `λ₁ + λ₂` as a polynomial.
    pub fn trace(&self) -> UnknownStep {
        self.matrix.trace()
    }

    /// `λ₁ · λ₂` as a polynomial.
    pub fn determinant(&self) -> UnknownStep {
        self.matrix.determinant()
    }

    /// `M(−z)·M(z) − 1`, which is zero for a time-reversible method; none if the polynomials outgrow
    /// their exact arithmetic.
    pub fn reversibility_residual(&self) -> Option<UpdateMatrix<UnknownStep>> {
        let round_trip = self.matrix.map(UnknownStep::reflected).after(&self.matrix);
        let residual =
            UpdateMatrix::from_map(|e| round_trip.apply(&e).plus(-UnknownStep::one(), e));
        residual.rows().iter().flatten().all(UnknownStep::is_valid).then_some(residual)
    }

    /// The quadratic form `Q` that the step carries along, `Q(My) = det M · Q(y)`, as polynomials.
    pub fn invariant(&self) -> QuadraticForm<UnknownStep> {
        QuadraticForm::carried_by(&self.matrix)
    }

    /// Whether the determinant is one for every time step, so that [`Self::invariant`] is conserved.
    pub fn is_symplectic(&self) -> bool {
        self.determinant() == UnknownStep::one()
    }
}

#[cfg(test)]
mod tests {
    use libration_core::integrator::{Rk4, SymplecticEuler, VelocityVerlet};
    use libration_core::number::Ratio;
    use libration_core::system::{DampedOscillator, Pendulum};

    use super::*;

    fn coefficients(p: &UnknownStep) -> [f64; 4] {
        [0, 1, 2, 3].map(|k| p.coefficient(k).to_f64())
    }

    #[test]
    fn the_modified_hamiltonians_are_those_of_the_textbooks() {
        // ½(v² + (1 − z²/4)x²) and ½(v² + x² − z·x·v), times 2z.
        let form = SymbolicStep::new(VelocityVerlet).unwrap().invariant();
        assert_eq!(coefficients(&form.qq), [0.0, 1.0, 0.0, -0.25]);
        assert_eq!(coefficients(&form.qv), [0.0; 4]);
        assert_eq!(coefficients(&form.vv), [0.0, 1.0, 0.0, 0.0]);
        let form = SymbolicStep::new(SymplecticEuler).unwrap().invariant();
        assert_eq!(coefficients(&form.qv), [0.0, 0.0, -0.5, 0.0]);
        assert!(!SymbolicStep::new(Rk4).unwrap().is_symplectic());
    }

    #[test]
    fn a_damped_mode_has_its_window_and_a_pendulum_has_no_matrix() {
        let damped = DampedOscillator { omega2: UnknownStep::one(), gamma: UnknownStep::one() };
        let step = SymbolicStep::of(libration_core::integrator::ExplicitEuler, &damped).unwrap();
        // det = 1 − γΔt + ω²Δt² ≤ 1 up to Δt = γ/ω².
        let [window] = step.stability_windows()[..] else { panic!() };
        assert_eq!(window.to.unwrap().to_f64(), 1.0);
        let pendulum = Pendulum { omega2: UnknownStep::constant(Ratio::ONE) };
        assert!(SymbolicStep::of(VelocityVerlet, &pendulum).is_none());
    }
}
