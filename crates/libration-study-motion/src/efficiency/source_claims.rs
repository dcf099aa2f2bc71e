//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] =
    &[SourceClaim::new("C81", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.6"])];
