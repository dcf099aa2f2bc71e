//! Derivatives of the simulator beside differences of its step.

use libration::linear::Matrix;
use serde::Serialize;

use crate::Subject;
use crate::linearised_step::LinearisedStep;

/// Part of the largest entry of a row by which derivatives of a simulator may differ: they are differences of one small step, whose
/// error in stiff contacts is 10⁻⁵ (measured on MuJoCo's `mjd_transitionFD`).
const THEIR_ERROR: f64 = 1e-4;

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
        let (mut difference, mut allowed) = (0.0_f64, THEIR_ERROR);
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
                allowed = allowed.max(THEIR_ERROR + largest(errors, i) / size);
            }
        }
        Some(ReferenceCheck { source: reference.source.clone(), difference, allowed })
    }
}
