//! The claims of the source report that this study tries.

use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C01", &[], &["9.7"]),
    Tried::new("C02", &[], &["9.7"]),
    Tried::new("C36", &[], &["9.7"]),
    Tried::new("C37", &[], &["9.7"]),
    Tried::new("C39", &[], &["9.7"]),
    Tried::new("C40", &[], &["9.7"]),
    Tried::new("C42", &[], &["9.8"]),
    // Of arrays that are counted.
    Tried::new("C44", &[], &[]),
    Tried::new("C45", &[], &["9.7"]),
    Tried::new("C46", &[], &["9.7"]),
    Tried::new("C47", &[], &["roofline"]),
    Tried::new("C68", &[], &["9.7"]),
    Tried::new("C69", &[], &[]),
    Tried::new("C82", &[], &["9.7"]),
];
