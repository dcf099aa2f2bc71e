//! The claims of the source report that this study tries.

use libration::Method::{Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C60", &[SymplecticEuler, VelocityVerlet, Rk4], &["9.13", "jitter-map"]),
    Tried::new("C64", &[VelocityVerlet], &["9.12"]),
    // Equality to the bit.
    Tried::new("C65", &[], &[]),
    Tried::new("C93", &[SymplecticEuler, VelocityVerlet], &["9.13", "9.12"]),
];
