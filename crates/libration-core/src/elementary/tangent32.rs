//! Tangent of an `f32`, in `f64` arithmetic.
//!
//! In `f32` the quotient would need a sum of two floats for each side, and more operations than the halved width
//! of the loop around it costs.

use core::f64::consts::FRAC_2_PI;

use super::sine32::RANGE;

/// Adding 1.5·2⁵² leaves no room for a fraction: it rounds to the nearest integer, whose low bits
/// are then the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// π/2 as a sum of two parts, its error below 2⁻⁸⁸. The first is a multiple of 2⁻³³: its product with an integer
/// of 17 bits is exact.
const PI_2: [f64; 2] = [1.570_796_326_850_541, -5.564_431_676_187_288_5e-11];

/// `(sin r − r)/r³` as a polynomial in `r²`: minimax for the relative error on `[-π/4, π/4]`, found by Remez's
/// exchange. The relative error of the sine is below 2⁻³⁷.
const SIN: [f64; 4] = [
    -0.166_666_666_416_438_43,
    0.008_333_329_387_801_425,
    -0.000_198_393_353_527_427_08,
    2.718_315_476_596_291_4e-6,
];

/// `(cos r − 1 + r²/2)/r⁴` as a polynomial in `r²`, found in the same way. The error of the cosine is below 2⁻⁴³.
const COS: [f64; 4] = [
    0.041_666_666_622_818_59,
    -0.001_388_888_375_280_764_2,
    2.479_951_988_362_613e-5,
    -2.721_022_942_283_433_7e-7,
];

const SIGN: u32 = 1 << 31;

/// Tangent of `x` radians, within 0.51 ulp for `|x|` up to [`RANGE`], NaN beyond.
#[inline(always)]
pub fn tan(x: f32) -> f32 {
    let a = f64::from(x.abs());
    let shifted = a * FRAC_2_PI + ROUNDER;
    let k = shifted - ROUNDER;
    // The first difference is exact.
    let r = (a - k * PI_2[0]) - k * PI_2[1];

    let z = r * r;
    let sine = r + z * r * horner(z, SIN);
    let cosine = 1.0 - z * (0.5 - z * horner(z, COS));
    // After an odd number of quarter turns the tangent is −cos/sin.
    let odd = shifted.to_bits() & 1 == 1;
    let (n, d) = if odd { (-cosine, sine) } else { (sine, cosine) };
    let value = f32::from_bits(((n / d) as f32).to_bits() ^ (x.to_bits() & SIGN));
    if x.abs() <= RANGE { value } else { f32::NAN }
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3]: [f64; 4]) -> f64 {
    c0 + z * (c1 + z * (c2 + z * c3))
}
