//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::Tried;

/// All of them, in the order of their numbers.
pub(super) const TRIED: &[Tried] = &[
    Tried::of_the_source_run("C03", &[VelocityVerlet, Rk4], &["9.1", "crossover"]),
    Tried::new("C10", &[SymplecticEuler], &["9.1", "9.2"]),
    Tried::new("C12", &[VelocityVerlet], &["9.1", "9.2"]),
    Tried::new("C15", &[Rk4], &["9.1", "9.2"]),
    Tried::of_the_source_run("C16", &[VelocityVerlet, Rk4], &["9.1", "crossover"]),
    Tried::new("C22", &[ExplicitEuler], &["9.1", "9.4"]),
    Tried::of_the_source_run("C25", &[VelocityVerlet, Rk4], &["9.1", "9.2"]),
    // Equality to the bit.
    Tried::new("C26", &[], &[]),
    Tried::new("C33", &[ExplicitEuler, Rk4], &["9.1"]),
    Tried::new("C34", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["portraits"]),
    Tried::of_the_source_run("C73", &[SymplecticEuler, VelocityVerlet, Rk4], &["9.1"]),
];
