//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C27", &[VelocityVerlet, Rk4], &["windows"]),
    SourceClaim::new("C28", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    SourceClaim::new("C30", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    SourceClaim::new("C35", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    SourceClaim::new("C70", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    SourceClaim::new("C80", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
];
