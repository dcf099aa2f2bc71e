//! One step as a matrix about a state, in 1024 bits.

use libration::analysis::{LinearMap, Linearisation};
use libration::number::Wide;
use serde::Serialize;

use super::modes::{Modes, flow_radius_minus_one};

/// The derivative of one step by positions and velocities, and what follows from it. All of it is computed with 1024 bits.
#[derive(Clone, Debug, Serialize)]
pub struct StepMatrix {
    /// The update matrix, row by row; rows and columns in the order `q₀ … v₀ …`.
    pub update_matrix: Vec<Vec<f64>>,
    /// The determinant: the factor by which volumes of phase space grow.
    pub determinant: f64,
    /// The determinant minus one, without cancellation.
    pub determinant_minus_one: f64,
    /// The trace.
    pub trace: f64,
    /// The eigenvalues as pairs `[re, im]`.
    pub eigenvalues: Vec<[f64; 2]>,
    /// The largest absolute value of an eigenvalue. Like the other fields, it belongs to the step without feedback.
    pub spectral_radius: f64,
    /// The spectral radius minus one, without cancellation.
    pub spectral_radius_minus_one: f64,
    /// The spectral radius of an exact step minus one: how much the motion itself grows, linearised likewise.
    pub flow_spectral_radius_minus_one: f64,
    /// The Frobenius norm of `MᵀJM − J`.
    pub symplecticity_defect: f64,
    /// The Frobenius norm of `M(−Δt)·M(Δt) − 1`.
    pub reversibility_defect: f64,
    /// Angle of the step minus that of the exact solution, in rad: the largest over the modes.
    pub phase_error_per_step: Option<f64>,
    /// Whether the phase error would be more than half a turn, so that steps do not follow the oscillation.
    #[serde(skip)]
    pub loses_oscillation: bool,
    /// Counted force evaluations per step.
    pub force_evaluations_per_step: u64,
}

impl StepMatrix {
    /// Defects that are not exact carry the rounding of 1024 bits.
    pub(crate) fn new(
        linear: &Linearisation,
        modes: &Modes,
        reversibility: Wide,
        evaluations: u64,
        is_exact: bool,
    ) -> Self {
        let rows = linear.step.rows();
        StepMatrix {
            update_matrix: rows
                .iter()
                .map(|row| row.iter().map(|x| x.to_f64()).collect())
                .collect(),
            determinant: modes.determinant.to_f64(),
            determinant_minus_one: modes.determinant_minus_one.to_f64(),
            trace: linear.step.trace().to_f64(),
            eigenvalues: modes.eigenvalues(),
            spectral_radius: modes.radius.to_f64(),
            spectral_radius_minus_one: modes.radius_minus_one.to_f64(),
            flow_spectral_radius_minus_one: flow_radius_minus_one(linear),
            symplecticity_defect: defect(modes.symplecticity_defect, is_exact),
            reversibility_defect: defect(reversibility, is_exact),
            phase_error_per_step: modes.followed_phase_error(),
            loses_oscillation: modes.loses_oscillation(),
            force_evaluations_per_step: evaluations,
        }
    }
}

/// Whether an entry is not a number, as where a force has no derivative.
pub(crate) fn is_undefined(map: &LinearMap) -> bool {
    map.rows().iter().flatten().any(|x| x.is_nan())
}

/// A defect in `f64`. An inexact defect below the rounding of 1024 bits is zero.
fn defect(norm: Wide, is_exact: bool) -> f64 {
    let value = norm.to_f64();
    if value < 1e-270 && !is_exact { 0.0 } else { value }
}
