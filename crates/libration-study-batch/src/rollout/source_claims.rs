//! The claims of the source report that this study tries.

use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C49", &[], &["step-times"]),
    // Of addresses.
    SourceClaim::new("C50", &[], &[]),
    SourceClaim::new("C55", &[], &["9.11"]),
    SourceClaim::new("C56", &[], &["9.9"]),
    // Equality to the bit.
    SourceClaim::new("C58", &[], &[]),
    SourceClaim::new("C84", &[], &["9.11"]),
    SourceClaim::new("C85", &[], &["9.11"]),
    SourceClaim::new("C86", &[], &["9.11"]),
    SourceClaim::new("C87", &[], &["9.11"]),
    SourceClaim::new("C88", &[], &["9.11"]),
    SourceClaim::new("C89", &[], &["step-times"]),
    SourceClaim::new("C91", &[], &["9.9", "step-times"]),
    SourceClaim::new("C95", &[], &["9.11"]),
    SourceClaim::new("C96", &[], &["9.9"]),
];
