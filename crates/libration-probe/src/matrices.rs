//! Matrices of a report.

use libration::linear::{Matrix, logarithm};
use serde::{Serialize, Serializer};

use crate::linearised_step::LinearisedStep;

/// Matrices `A` and `B`.
#[derive(Clone, Debug, Serialize)]
pub struct Matrices {
    /// States × states.
    #[serde(serialize_with = "rows")]
    pub a: Matrix,
    /// States × inputs.
    #[serde(serialize_with = "rows")]
    pub b: Matrix,
    /// Estimated absolute errors of `a`.
    #[serde(serialize_with = "rows")]
    pub a_errors: Matrix,
}

fn rows<S: Serializer>(matrix: &Matrix, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq((0..matrix.rows()).map(|i| matrix.row(i)))
}

/// The rates whose exact flow under a held command is the step.
pub(crate) fn modified_flow(step: &LinearisedStep) -> Option<Matrices> {
    let rates = logarithm(&step.augmented())?.scaled(step.dt.recip());
    let (n, m) = (step.a.rows(), step.b.columns());
    Some(Matrices {
        a: rates.block((0, 0), (n, n)),
        b: rates.block((0, n), (n, m)),
        a_errors: step.a_errors.scaled(step.dt.recip()),
    })
}
