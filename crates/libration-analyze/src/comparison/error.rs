//! Errors of comparisons.

use std::ops::RangeInclusive;

use libration_work::Interrupted;
use thiserror::Error;

use super::ComparisonRequest;

/// Error of a comparison of integrators.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ComparisonError {
    /// The time of the motion is no time.
    #[error("horizon {horizon:e}: expected a positive, finite number of seconds")]
    Horizon {
        /// The value.
        horizon: f64,
    },
    /// The tolerance is out of range.
    #[error("tolerance {tolerance:e}: expected a number from 1e-13 to 0.1")]
    Tolerance {
        /// The value.
        tolerance: f64,
    },
    /// A coordinate of the start is not finite, or the motion ends.
    #[error(
        "the motion is not finite after {time} s; expected a motion that is finite until {horizon} s"
    )]
    NotFinite {
        /// The time.
        time: f64,
        /// The time of the motion.
        horizon: f64,
    },
    /// The reference finds no smooth motion from some time on.
    #[error(
        "the motion cannot be followed to the tolerance after {time} s of {horizon} s: it ends there, or its forces jump; help: a shorter horizon or a larger tolerance"
    )]
    NotSmooth {
        /// The time.
        time: f64,
        /// The time of the motion.
        horizon: f64,
    },
    /// The motion has too many turns.
    #[error(
        "the reference takes too many pieces to follow the motion beyond {time} s of {horizon} s; help: a shorter horizon"
    )]
    TooLong {
        /// The time that was reached.
        time: f64,
        /// The time of the motion.
        horizon: f64,
    },
    /// The system stays where it is.
    #[error("the system rests at its start; expected a start from which it moves")]
    AtRest,
    /// The reference is less certain than the tolerance requires.
    #[error(
        "the reference is known to {reference_error:.1e} at {horizon} s, not to a tenth of the tolerance {tolerance:e}; help: a shorter horizon or a larger tolerance"
    )]
    Reference {
        /// The uncertainty, in the measure of the tolerance.
        reference_error: f64,
        /// The time of the motion.
        horizon: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// The user stopped the work.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for ComparisonError {
    fn from(_: Interrupted) -> Self {
        ComparisonError::Interrupted
    }
}

/// The tolerances of comparisons: references are known to 1e-14.
pub const TOLERANCES: RangeInclusive<f64> = 1e-13..=0.1;

/// Checks a request before any work.
pub(super) fn check(request: &ComparisonRequest) -> Result<(), ComparisonError> {
    let ComparisonRequest { horizon, tolerance, .. } = *request;
    if !(horizon.is_finite() && horizon > 0.0) {
        return Err(ComparisonError::Horizon { horizon });
    }
    if !TOLERANCES.contains(&tolerance) {
        return Err(ComparisonError::Tolerance { tolerance });
    }
    if request.system.initial_state().iter().any(|x| !x.is_finite()) {
        return Err(ComparisonError::NotFinite { time: 0.0, horizon });
    }
    Ok(())
}
