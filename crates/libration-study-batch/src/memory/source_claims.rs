//! The claims of the source report that this study tries.

use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    // Products and sums.
    SourceClaim::new("C48", &[], &[]),
    SourceClaim::new("C52", &[], &["9.10"]),
    SourceClaim::new("C53a", &[], &["9.10"]),
    SourceClaim::new("C54", &[], &["9.10"]),
    SourceClaim::new("C57", &[], &["9.10"]),
    SourceClaim::new("C90", &[], &["9.10"]),
];
