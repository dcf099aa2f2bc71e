//! The claims of the source report that this study tries.

use libration::Method::{Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::new("C43", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
    Tried::new("C53", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
    // Of angles, which stand in a table.
    Tried::new("C58a", &[SymplecticEuler], &[]),
    Tried::of_the_source_run("C59", &[SymplecticEuler, VelocityVerlet], &[]),
    Tried::of_the_source_run("C59a", &[VelocityVerlet], &[]),
    Tried::new("C59b", &[VelocityVerlet], &[]),
    Tried::of_the_source_run("C59c", &[], &[]),
    Tried::new("C67a", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
];
