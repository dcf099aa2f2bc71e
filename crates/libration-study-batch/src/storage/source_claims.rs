//! The claims of the source report that this study tries.

use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[SourceClaim::new("C51", &[], &["draws"])];
