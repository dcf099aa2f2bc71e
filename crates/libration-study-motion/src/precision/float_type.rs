//! The float types under study.

use half::{bf16, f16};
use libration::number::{Compensated, Mantissa, TwoFloat};
use libration_study::Lab;

use super::verlet_run;
use super::verlet_run::VerletRun;

/// A float type, and how it is tried.
pub(super) struct FloatType {
    /// Name in identifiers and on the page.
    pub(super) name: &'static str,
    /// Bits of the significand.
    pub(super) bits: u32,
    /// Whether sums keep what they round off.
    pub(super) compensated: bool,
    /// Follows many orbits in it; none where it does not hold the setting.
    pub(super) run: fn(&Lab<'_>, &FloatType) -> Option<VerletRun>,
}

const fn plain(
    name: &'static str,
    bits: u32,
    run: fn(&Lab<'_>, &FloatType) -> Option<VerletRun>,
) -> FloatType {
    FloatType { name, bits, compensated: false, run }
}

/// All float types, by ascending precision. The wide type is `f64` up to 36 bits.
pub(super) const FLOAT_TYPES: &[FloatType] = &[
    plain("bf16", 8, verlet_run::run::<bf16, f64>),
    plain("f16", 11, verlet_run::run::<f16, f64>),
    plain("14-bit", 14, verlet_run::run::<Mantissa<14>, f64>),
    plain("17-bit", 17, verlet_run::run::<Mantissa<17>, f64>),
    plain("20-bit", 20, verlet_run::run::<Mantissa<20>, f64>),
    plain("f32", 24, verlet_run::run::<f32, f64>),
    FloatType {
        name: "f32-compensated",
        bits: 24,
        compensated: true,
        run: verlet_run::run::<Compensated, f64>,
    },
    plain("30-bit", 30, verlet_run::run::<Mantissa<30>, f64>),
    plain("36-bit", 36, verlet_run::run::<Mantissa<36>, f64>),
    plain("44-bit", 44, verlet_run::run::<Mantissa<44>, TwoFloat>),
    plain("f64", 53, verlet_run::run::<f64, TwoFloat>),
];
