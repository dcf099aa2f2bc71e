//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C07", &[ExplicitEuler, Rk4], &["order-global", "order-local"]),
    SourceClaim::new("C24", &[VelocityVerlet], &["order-global"]),
];
