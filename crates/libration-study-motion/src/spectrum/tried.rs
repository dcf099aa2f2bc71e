//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    // Of the oscillator itself, before any step.
    Tried::new("C04", &[], &[]),
    Tried::new("C05", &[ExplicitEuler], &["stability-regions", "9.4"]),
    // A single orbit at z = 2.
    Tried::new("C06", &[SymplecticEuler], &[]),
    Tried::new("C08", &[ExplicitEuler], &["stability-regions"]),
    Tried::new("C09", &[SymplecticEuler], &["stability-regions"]),
    // Defects that are zero.
    Tried::new("C11", &[SymplecticEuler, VelocityVerlet], &[]),
    Tried::new("C13", &[SymplecticEuler, VelocityVerlet], &["stability-regions"]),
    Tried::new("C14", &[Rk4], &["portraits"]),
    Tried::new("C17", &[VelocityVerlet], &["stability-regions"]),
    Tried::new("C18", &[VelocityVerlet, Rk4], &["stability-regions"]),
    Tried::new("C23", &[SymplecticEuler], &["stability-regions"]),
    Tried::new("C32", &[ExplicitEuler], &["stability-regions"]),
];
