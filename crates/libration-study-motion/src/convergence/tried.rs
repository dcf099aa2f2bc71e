//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, VelocityVerlet};
use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C07", &[ExplicitEuler, Rk4], &["order-global", "order-local"]),
    Tried::new("C24", &[VelocityVerlet], &["order-global"]),
];
