//! Sine and cosine of an `f64`.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// The largest magnitude of an argument: 2²⁰·π/2.
///
/// Up to here `k` fits in 20 bits, or is 2²⁰ itself, and the products of the reduction are exact.
pub const RANGE: f64 = 1_048_576.0 * FRAC_PI_2;

/// Adding 1.5·2⁵² leaves no room for a fraction: it rounds to the nearest integer, whose low bits
/// are then the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

const SIGN: u64 = 1 << 63;

/// π/2 as a sum of four parts, its error below 2⁻¹⁴¹. The multiples of 2⁻³², 2⁻⁵³ and 2⁻⁸⁶ nearest
/// to what remains of π/2 come first; the last takes all the rest that an `f64` can hold.
const PI_2: [f64; 4] = [
    1.570_796_326_734_125_6,
    6.077_105_485_502_443e-11,
    -4.978_996_250_866_955_5e-17,
    3.521_559_865_183_2e-27,
];

/// `(sin r − r)/r³` as a polynomial in `r²`: the minimax coefficients of fdlibm's `__kernel_sin`.
const SIN: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_49,
    -0.000_198_412_698_298_579_5,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// `(cos r − 1 + r²/2)/r⁴` as a polynomial in `r²`: the minimax coefficients of fdlibm's
/// `__kernel_cos`.
const COS: [f64; 6] = [
    0.041_666_666_666_666_6,
    -0.001_388_888_888_887_411,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine of `x` radians, within 0.79 ulp for `|x|` up to [`RANGE`], NaN beyond.
#[inline(always)]
pub fn sin(x: f64) -> f64 {
    // On |x|, so that the function is odd whatever the roundings; |x| also loses the sign of zero.
    turn(x.abs(), 0, x.to_bits() & SIGN)
}

/// Cosine of `x` radians, within 0.79 ulp for `|x|` up to [`RANGE`], NaN beyond.
#[inline(always)]
pub fn cos(x: f64) -> f64 {
    turn(x.abs(), 1, 0)
}

/// `±sin(a + quarters·π/2)` for `a ≥ 0`, negated if `sign` is the sign bit.
#[inline(always)]
fn turn(a: f64, quarters: u64, sign: u64) -> f64 {
    let (k, r, tail) = reduce(a);
    let k = k.wrapping_add(quarters);
    let (sine, cosine) = kernels(r, tail);

    let odd = (k & 1).wrapping_neg();
    let magnitude = (sine.to_bits() & !odd) | (cosine.to_bits() & odd);
    let value = f64::from_bits(magnitude ^ ((k & 2) << 62) ^ sign);
    if a <= RANGE { value } else { f64::NAN }
}

/// The integer `k` nearest to `a / (π/2)` (its low bits only) and `a − k·π/2` as an unevaluated sum.
#[inline(always)]
pub(super) fn reduce(a: f64) -> (u64, f64, f64) {
    let shifted = a * FRAC_2_PI + ROUNDER;
    let k = shifted - ROUNDER;

    // Exact: unless k is 0, both sides are multiples of 2⁻⁵³, and the difference is below 1.
    let r = (a - k * PI_2[0]) - k * PI_2[1];
    // Dekker's fast sum is valid though |r| may be the smaller: r is a multiple of the product's ulp.
    let third = k * PI_2[2];
    let head = r - third;
    let tail = ((r - head) - third) - k * PI_2[3];
    (shifted.to_bits(), head, tail)
}

/// Sine and cosine of `r + tail` for `|r| ≤ π/4`, where `tail` is at most an ulp of `r` or both are tiny.
#[inline(always)]
fn kernels(r: f64, tail: f64) -> (f64, f64) {
    let (sine, base, cosine) = corrections(r, tail);
    (r + sine, base + cosine)
}

/// The sine minus `r`, a number near the cosine, and the cosine minus that number.
#[inline(always)]
pub(super) fn corrections(r: f64, tail: f64) -> (f64, f64, f64) {
    let z = r * r;
    let half = 0.5 * z;
    // 1 − z/2 rounds; what it lost is recovered exactly below.
    let base = 1.0 - half;

    let sine = z * r * horner(z, SIN) + tail * base;
    let cosine = ((1.0 - base) - half) + (z * z * horner(z, COS) - r * tail);
    (sine, base, cosine)
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3, c4, c5]: [f64; 6]) -> f64 {
    c0 + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * c5))))
}
