//! Deviations that are scaled by the error_scale of an episode.

use libration_core::Float;

/// What is, if it is so many times as far from what should be: with a factor of 1, what is to the last bit.
#[inline(always)]
pub(super) fn scale_deviation<T: Float>(is: T, should_be: T, factor: T) -> T {
    is + (factor - T::one()) * (is - should_be)
}
