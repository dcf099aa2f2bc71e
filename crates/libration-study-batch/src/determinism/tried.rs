//! The claims of the source report that this study tries.

use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    // Of bits, which are counted in a table.
    Tried::new("C66", &[], &[]),
];
