//! The claims of the source report that this study tries.

use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C61", &[], &["9.14", "9.15"]),
    SourceClaim::new("C62", &[], &["latency-map-gain", "latency-map-step"]),
    SourceClaim::new("C63", &[], &["9.14", "9.15"]),
];
