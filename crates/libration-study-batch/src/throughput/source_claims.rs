//! The claims of the source report that this study tries.

use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C01", &[], &["9.7"]),
    SourceClaim::new("C02", &[], &["9.7"]),
    SourceClaim::new("C36", &[], &["9.7"]),
    SourceClaim::new("C37", &[], &["9.7"]),
    SourceClaim::new("C39", &[], &["9.7"]),
    SourceClaim::new("C40", &[], &["9.7"]),
    SourceClaim::new("C42", &[], &["9.8"]),
    // Of arrays that are counted.
    SourceClaim::new("C44", &[], &[]),
    SourceClaim::new("C45", &[], &["9.7"]),
    SourceClaim::new("C46", &[], &["9.7"]),
    SourceClaim::new("C47", &[], &["roofline"]),
    SourceClaim::new("C68", &[], &["9.7"]),
    SourceClaim::new("C69", &[], &[]),
    SourceClaim::new("C82", &[], &["9.7"]),
];
