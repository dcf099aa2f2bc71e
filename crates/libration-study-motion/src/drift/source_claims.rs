//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::of_the_source_run("C03", &[VelocityVerlet, Rk4], &["9.1", "crossover"]),
    SourceClaim::new("C10", &[SymplecticEuler], &["9.1", "9.2"]),
    SourceClaim::new("C12", &[VelocityVerlet], &["9.1", "9.2"]),
    SourceClaim::new("C15", &[Rk4], &["9.1", "9.2"]),
    SourceClaim::of_the_source_run("C16", &[VelocityVerlet, Rk4], &["9.1", "crossover"]),
    SourceClaim::new("C22", &[ExplicitEuler], &["9.1", "9.4"]),
    SourceClaim::of_the_source_run("C25", &[VelocityVerlet, Rk4], &["9.1", "9.2"]),
    // Equality to the bit.
    SourceClaim::new("C26", &[], &[]),
    SourceClaim::new("C33", &[ExplicitEuler, Rk4], &["9.1"]),
    SourceClaim::new("C34", &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4], &["portraits"]),
    SourceClaim::of_the_source_run("C73", &[SymplecticEuler, VelocityVerlet, Rk4], &["9.1"]),
];
