//! The claims of the source report that this study tries.

use libration::Method::{Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C60", &[SymplecticEuler, VelocityVerlet, Rk4], &["9.13", "jitter-map"]),
    SourceClaim::new("C64", &[VelocityVerlet], &["9.12"]),
    // Equality to the bit.
    SourceClaim::new("C65", &[], &[]),
    SourceClaim::new("C93", &[SymplecticEuler, VelocityVerlet], &["9.13", "9.12"]),
];
