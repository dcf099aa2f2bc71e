//! The claims of the source report that this study tries.

use libration::Method::{Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    SourceClaim::new("C43", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
    SourceClaim::new("C53", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
    // Of angles, which stand in a table.
    SourceClaim::new("C58a", &[SymplecticEuler], &[]),
    SourceClaim::of_the_source_run("C59", &[SymplecticEuler, VelocityVerlet], &[]),
    SourceClaim::of_the_source_run("C59a", &[VelocityVerlet], &[]),
    SourceClaim::new("C59b", &[VelocityVerlet], &[]),
    SourceClaim::of_the_source_run("C59c", &[], &[]),
    SourceClaim::new("C67a", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
];
