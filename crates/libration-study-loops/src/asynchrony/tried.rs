//! The claims of the source report that this study tries.

use libration::Method::VelocityVerlet;
use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C65a", &[VelocityVerlet], &["dephasing", "asynchrony-alone"]),
    Tried::new("C71", &[VelocityVerlet], &[]),
];
