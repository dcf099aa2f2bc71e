//! Derivatives of the simulator beside differences of its step.

use libration::linear::Matrix;
use serde::Serialize;

use crate::Subject;
use crate::linearised_step::LinearisedStep;

/// Part of the largest entry of a row by which derivatives of a simulator may differ: they are differences of one small step, whose
/// error in stiff contacts is 10⁻⁵ (measured on MuJoCo's `mjd_transitionFD`).
const THEIR_ERROR: f64 = 1e-4;

/// The same for derivatives that are exact but for some roundings, whose terms may cancel.
const ROUNDING: f64 = 1e-12;
/// Estimated errors by which a difference may be off from an exact derivative: at most 1.17 of 80,000 points, and all below 2 in
/// `test_derivatives.py`.
const ERRORS: f64 = 3.0;

/// A comparison with derivatives of the simulator.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceCheck {
    /// The function that computed them.
    pub source: String,
    /// The largest difference of an entry, relative to the largest entry of its row.
    pub difference: f64,
    /// The difference that errors of the derivatives explain.
    pub allowed: f64,
}

impl ReferenceCheck {
    pub(crate) fn of(subject: &Subject, step: &LinearisedStep) -> Option<Self> {
        let reference = subject.reference.as_ref()?;
        let (their_error, of_own) =
            if reference.is_exact { (ROUNDING, ERRORS) } else { (THEIR_ERROR, 1.0) };
        let (mut difference, mut allowed) = (0.0_f64, their_error);
        let largest =
            |matrix: &Matrix, i: usize| matrix.row(i).iter().map(|x| x.abs()).fold(0.0, f64::max);
        for i in 0..step.a.rows() {
            let parts =
                [(&step.a, &reference.a, &step.a_errors), (&step.b, &reference.b, &step.b_errors)];
            let size = parts.iter().map(|(own, theirs, _)| largest(own, i).max(largest(theirs, i)));
            let size = size.fold(f64::MIN_POSITIVE, f64::max);
            for (own, theirs, errors) in parts {
                let apart = own.row(i).iter().zip(theirs.row(i)).map(|(a, b)| (a - b).abs());
                difference = difference.max(apart.fold(0.0, f64::max) / size);
                allowed = allowed.max(their_error + of_own * largest(errors, i) / size);
            }
        }
        Some(ReferenceCheck { source: reference.source.clone(), difference, allowed })
    }

    /// Replaces the matrices of the step by exact ones that agree with them.
    pub(crate) fn refine(&self, subject: &Subject, step: &mut LinearisedStep) {
        let exact = subject.reference.as_ref().filter(|reference| reference.is_exact);
        let Some(exact) = exact.filter(|_| self.difference <= self.allowed) else { return };
        let parts = [
            (&mut step.a, &exact.a, &mut step.a_errors),
            (&mut step.b, &exact.b, &mut step.b_errors),
        ];
        for (own, theirs, errors) in parts {
            own.clone_from(theirs);
            // Some roundings of the entry, where they are less than the error of the difference.
            let places =
                |i: usize, j: usize| errors[(i, j)].min(8.0 * f64::EPSILON * own[(i, j)].abs());
            *errors = Matrix::from_fn(own.rows(), own.columns(), places);
        }
    }
}
