//! The claims of the source report that this study tries.

use libration::Method::VelocityVerlet;
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C65a", &[VelocityVerlet], &["dephasing", "asynchrony-alone"]),
    SourceClaim::new("C71", &[VelocityVerlet], &[]),
];
