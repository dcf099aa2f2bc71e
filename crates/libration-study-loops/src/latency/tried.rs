//! The claims of the source report that this study tries.

use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C61", &[], &["9.14", "9.15"]),
    Tried::new("C62", &[], &["latency-map-gain", "latency-map-step"]),
    Tried::new("C63", &[], &["9.14", "9.15"]),
];
