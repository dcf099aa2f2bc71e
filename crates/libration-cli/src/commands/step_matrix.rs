//! One step as a matrix, line by line.

use libration_analyze::StepMatrix;

use super::digits::{beside_one, short};
use super::summary::no_phase_error;

/// Gives the matrix and its eigenvalues as lines with a name and a value; `in_z` has its polynomials.
pub(super) fn describe(
    matrix: &StepMatrix,
    in_z: Option<&[Vec<String>]>,
    line: &mut dyn FnMut(&str, String),
) {
    let first = |i: usize, name: &'static str| if i == 0 { name } else { "" };
    for (i, row) in matrix.update_matrix.iter().enumerate() {
        let row: String = row.iter().map(|x| format!("{:>24}", short(*x))).collect();
        line(first(i, "update matrix"), row.trim_end().to_owned());
    }
    for (i, row) in in_z.unwrap_or_default().iter().enumerate() {
        let row = row.iter().map(|entry| format!(" {entry:>23}")).collect();
        line(first(i, "at omega = 1, z = dt"), row);
    }
    line("determinant", beside_one(matrix.determinant, matrix.determinant_minus_one));
    line("trace", short(matrix.trace));
    for (i, [re, im]) in matrix.eigenvalues.iter().enumerate() {
        let sign = if im.is_sign_negative() { '-' } else { '+' };
        line(first(i, "eigenvalues"), format!("{} {sign} {} i", short(*re), short(im.abs())));
    }
    line("spectral radius", beside_one(matrix.spectral_radius, matrix.spectral_radius_minus_one));
    let of_flow = matrix.flow_spectral_radius_minus_one;
    line("of an exact step", beside_one(1.0 + of_flow, of_flow));
}

/// Gives the defects of a step, its phase error and its cost likewise.
pub(super) fn describe_defects(matrix: &StepMatrix, line: &mut dyn FnMut(&str, String)) {
    line("symplecticity defect", short(matrix.symplecticity_defect));
    line("reversibility defect", short(matrix.reversibility_defect));
    let phase_error = matrix.phase_error_per_step.map(|error| format!("{} rad", short(error)));
    line("phase error per step", phase_error.unwrap_or_else(|| no_phase_error(matrix).into()));
    line("force evaluations", format!("{} a step", matrix.force_evaluations_per_step));
}
