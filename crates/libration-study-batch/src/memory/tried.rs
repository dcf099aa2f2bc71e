//! The claims of the source report that this study tries.

use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    // Products and sums.
    Tried::new("C48", &[], &[]),
    Tried::new("C52", &[], &["9.10"]),
    Tried::new("C53a", &[], &["9.10"]),
    Tried::new("C54", &[], &["9.10"]),
    Tried::new("C57", &[], &["9.10"]),
    Tried::new("C90", &[], &["9.10"]),
];
