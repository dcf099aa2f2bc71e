//! Errors that say nothing.

/// Whether an error exceeds its result, or is no number.
pub(crate) fn is_unknown_error(error: f64) -> bool {
    error.is_nan() || error > 1.0
}
