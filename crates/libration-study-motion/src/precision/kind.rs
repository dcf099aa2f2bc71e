//! The float types under study.

use half::{bf16, f16};
use libration::number::{Compensated, Mantissa, TwoFloat};
use libration_study::Lab;

use super::trial;
use super::trial::Trial;

/// A float type, and how it is tried.
pub(super) struct Kind {
    /// Name in identifiers and on the page.
    pub(super) name: &'static str,
    /// Bits of the significand.
    pub(super) bits: u32,
    /// Whether sums keep what they round off.
    pub(super) compensated: bool,
    /// Follows many orbits in it; none where it does not hold the setting.
    pub(super) run: fn(&Lab<'_>, &Kind) -> Option<Trial>,
}

const fn plain(name: &'static str, bits: u32, run: fn(&Lab<'_>, &Kind) -> Option<Trial>) -> Kind {
    Kind { name, bits, compensated: false, run }
}

/// All of them, by rising precision. An `f64` is much wider than up to 36 bits.
pub(super) const KINDS: &[Kind] = &[
    plain("bf16", 8, trial::run::<bf16, f64>),
    plain("f16", 11, trial::run::<f16, f64>),
    plain("14-bit", 14, trial::run::<Mantissa<14>, f64>),
    plain("17-bit", 17, trial::run::<Mantissa<17>, f64>),
    plain("20-bit", 20, trial::run::<Mantissa<20>, f64>),
    plain("f32", 24, trial::run::<f32, f64>),
    Kind {
        name: "f32-compensated",
        bits: 24,
        compensated: true,
        run: trial::run::<Compensated, f64>,
    },
    plain("30-bit", 30, trial::run::<Mantissa<30>, f64>),
    plain("36-bit", 36, trial::run::<Mantissa<36>, f64>),
    plain("44-bit", 44, trial::run::<Mantissa<44>, TwoFloat>),
    plain("f64", 53, trial::run::<f64, TwoFloat>),
];
