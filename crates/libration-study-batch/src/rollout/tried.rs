//! The claims of the source report that this study tries.

use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C49", &[], &["step-times"]),
    // Of addresses.
    Tried::new("C50", &[], &[]),
    Tried::new("C55", &[], &["9.11"]),
    Tried::new("C56", &[], &["9.9"]),
    // Equality to the bit.
    Tried::new("C58", &[], &[]),
    Tried::new("C84", &[], &["9.11"]),
    Tried::new("C85", &[], &["9.11"]),
    Tried::new("C86", &[], &["9.11"]),
    Tried::new("C87", &[], &["9.11"]),
    Tried::new("C88", &[], &["9.11"]),
    Tried::new("C89", &[], &["step-times"]),
    Tried::new("C91", &[], &["9.9", "step-times"]),
    Tried::new("C95", &[], &["9.11"]),
    Tried::new("C96", &[], &["9.9"]),
];
