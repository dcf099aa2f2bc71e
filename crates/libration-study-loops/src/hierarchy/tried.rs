//! The claims of the source report that this study tries.

use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[Tried::new("C67", &[], &["9.16", "9.17"])];
