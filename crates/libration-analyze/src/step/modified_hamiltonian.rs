//! The quadratic form that a symplectic step conserves.

use libration::Scalar;
use libration::analysis::{LinearMap, QuadraticForm};
use libration::number::Wide;
use serde::Serialize;

/// The quadratic form `qq·q² + 2·qv·q·v + vv·v²` per unit mass that a symplectic step conserves in place of the
/// energy, for each degree of freedom. It is scaled to `vv = ½`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ModifiedHamiltonian {
    /// Coefficient of `q²`, in s⁻².
    pub qq: f64,
    /// Half the coefficient of `q·v`, in s⁻¹.
    pub qv: f64,
    /// Coefficient of `v²`.
    pub vv: f64,
}

impl ModifiedHamiltonian {
    /// The form of a linear step; none if the step does not conserve areas in each degree of
    /// freedom, or if `q` does not depend on `v`.
    pub(crate) fn of(step: &LinearMap, conserves: bool) -> Option<Self> {
        let blocks = step.decoupled()?;
        let form = QuadraticForm::carried_by(&blocks[0]);
        let scaled = |x: Wide| (x / form.vv).ratio(1, 2).to_f64();
        // A cross term that symmetry forbids comes out as rounding of the 1024 bits.
        let (cross, square) = (form.qv * form.qv, form.qq * form.vv);
        let rounding = match (cross.exponent(), square.exponent()) {
            (Some(cross), Some(square)) => cross < square - 1800,
            _ => false,
        };
        let qv = if rounding { 0.0 } else { scaled(form.qv) };
        (conserves && !form.vv.is_zero()).then(|| ModifiedHamiltonian {
            qq: scaled(form.qq),
            qv,
            vv: scaled(form.vv),
        })
    }
}
