//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C27", &[VelocityVerlet, Rk4], &["windows"]),
    Tried::new("C28", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    Tried::new("C30", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    Tried::new("C35", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    Tried::new("C70", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
    Tried::new("C80", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["9.5"]),
];
