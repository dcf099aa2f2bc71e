//! Deviations scaled by the error scale of an episode.

use libration_core::Float;

/// Scales the deviation of a value from its ideal by `factor`. A factor of 1 returns `is` to the last bit.
#[inline(always)]
pub(super) fn scale_deviation<T: Float>(is: T, should_be: T, factor: T) -> T {
    is + (factor - T::one()) * (is - should_be)
}
