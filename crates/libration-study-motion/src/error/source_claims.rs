//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::of_the_source_run("C19", &[Rk4], &["9.3"]),
    SourceClaim::of_the_source_run("C74", &[ExplicitEuler], &["9.3"]),
    SourceClaim::of_the_source_run("C75", &[SymplecticEuler], &["9.3"]),
    SourceClaim::of_the_source_run("C76", &[VelocityVerlet], &["9.3"]),
    SourceClaim::of_the_source_run("C77", &[Rk4], &["9.3"]),
    SourceClaim::of_the_source_run(
        "C78",
        &[ExplicitEuler, SymplecticEuler, VelocityVerlet],
        &["9.3"],
    ),
    SourceClaim::of_the_source_run(
        "C79",
        &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4],
        &["9.3", "error-step"],
    ),
];
