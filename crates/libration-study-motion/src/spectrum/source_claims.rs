//! The claims of the source report that this study tries.

use libration::Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_study::SourceClaim;

/// All of them, in the order of their numbers.
pub(super) const SOURCE_CLAIMS: &[SourceClaim] = &[
    // Of the oscillator itself, before any step.
    SourceClaim::new("C04", &[], &[]),
    SourceClaim::new("C05", &[ExplicitEuler], &["stability-regions", "9.4"]),
    // A single orbit at z = 2.
    SourceClaim::new("C06", &[SymplecticEuler], &[]),
    SourceClaim::new("C08", &[ExplicitEuler], &["stability-regions"]),
    SourceClaim::new("C09", &[SymplecticEuler], &["stability-regions"]),
    // Defects that are zero.
    SourceClaim::new("C11", &[SymplecticEuler, VelocityVerlet], &[]),
    SourceClaim::new("C13", &[SymplecticEuler, VelocityVerlet], &["stability-regions"]),
    SourceClaim::new("C14", &[Rk4], &["portraits"]),
    SourceClaim::new("C17", &[VelocityVerlet], &["stability-regions"]),
    SourceClaim::new("C18", &[VelocityVerlet, Rk4], &["stability-regions"]),
    SourceClaim::new("C23", &[SymplecticEuler], &["stability-regions"]),
    SourceClaim::new("C32", &[ExplicitEuler], &["stability-regions"]),
];
