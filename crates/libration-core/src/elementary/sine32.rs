//! Sine and cosine of an `f32`, in `f32` arithmetic throughout.
//!
//! A detour through `f64` would need fewer operations, but it would halve the width of the loop
//! around it.

use core::f32::consts::{FRAC_2_PI, FRAC_PI_2};

use crate::Scalar;

/// The largest magnitude of an argument: 2¹⁶·π/2.
///
/// Up to here `k` fits in 16 bits, or is 2¹⁶ itself, and the products of the reduction are exact.
pub const RANGE: f32 = 65_536.0 * FRAC_PI_2;

/// Adding 1.5·2²³ leaves no room for a fraction: it rounds to the nearest integer, whose low bits
/// are then the low bits of the sum.
const ROUNDER: f32 = 12_582_912.0;

const SIGN: u32 = 1 << 31;

/// π/2 as a sum of six parts, its error below 2⁻⁶⁸. The multiples of 2⁻⁷, 2⁻¹⁶, 2⁻²⁴, 2⁻³² and 2⁻⁴¹
/// nearest to what remains of π/2 come first; the last takes all the rest that an `f32` can hold.
const PI_2: [f32; 6] = [
    1.570_312_5,
    0.000_488_281_25,
    -4.470_348_4e-6,
    1.583_248_4e-8,
    6.093_614_5e-11,
    -1.651_399_6e-13,
];

/// `(sin r − r)/r³` as a polynomial in `r²`: minimax for the relative error on `[-π/4, π/4]`, found
/// by Remez's exchange and a search among the neighbouring floats. Its error is below 2⁻²⁷.
const SIN: [f32; 3] = [-0.166_666_54, 0.008_332_144_5, -0.000_195_150_99];

/// `(cos r − 1 + r²/2)/r⁴` as a polynomial in `r²`, found in the same way. Its error is below 2⁻³².
const COS: [f32; 3] = [0.041_666_646, -0.001_388_731_3, 2.443_296_6e-5];

/// Sine of `x` radians, within 0.81 ulp for `|x|` up to [`RANGE`], NaN beyond.
#[inline(always)]
pub fn sin(x: f32) -> f32 {
    // On |x|, so that the function is odd whatever the roundings; |x| also loses the sign of zero.
    turn(x.abs(), 0, x.to_bits() & SIGN)
}

/// Cosine of `x` radians, within 0.81 ulp for `|x|` up to [`RANGE`], NaN beyond.
#[inline(always)]
pub fn cos(x: f32) -> f32 {
    turn(x.abs(), 1, 0)
}

/// `±sin(a + quarters·π/2)` for `a ≥ 0`, negated if `sign` is the sign bit.
#[inline(always)]
fn turn(a: f32, quarters: u32, sign: u32) -> f32 {
    let (shifted, [sine, cosine]) = arithmetic(a);
    let k = shifted.to_bits().wrapping_add(quarters);

    let odd = (k & 1).wrapping_neg();
    let magnitude = (sine.to_bits() & !odd) | (cosine.to_bits() & odd);
    let value = f32::from_bits(magnitude ^ ((k & 2) << 30) ^ sign);
    if a <= RANGE { value } else { f32::NAN }
}

/// The arithmetic of both functions: a number whose low bits are those of the integer `k` nearest to
/// `a / (π/2)`, and sine and cosine of `a − k·π/2`. Generic, so that it can be counted.
#[inline(always)]
pub fn arithmetic<T: Scalar>(a: T) -> (T, [T; 2]) {
    let (shifted, r, tail) = reduce(a);
    (shifted, kernels(r, tail))
}

/// A constant.
#[inline(always)]
fn number<T: Scalar>(c: f32) -> T {
    T::from_f64(f64::from(c))
}

/// As [`arithmetic`] has it, but with `a − k·π/2` as an unevaluated sum.
#[inline(always)]
fn reduce<T: Scalar>(a: T) -> (T, T, T) {
    let shifted = a * number(FRAC_2_PI) + number(ROUNDER);
    let k = shifted - number(ROUNDER);
    let part = |i: usize| k * number(PI_2[i]);

    // Exact: unless k is 0, both sides are multiples of 2⁻²⁴, and the difference is below 1.
    let r = ((a - part(0)) - part(1)) - part(2);
    // Dekker's fast sum is valid though |r| may be the smaller: r is a multiple of the product's ulp.
    let (r, fourth) = difference(r, part(3));
    let (r, fifth) = difference(r, part(4));
    (shifted, r, (fourth + fifth) - part(5))
}

/// `a − b` rounded, and what the rounding lost.
#[inline(always)]
fn difference<T: Scalar>(a: T, b: T) -> (T, T) {
    let rounded = a - b;
    (rounded, (a - rounded) - b)
}

/// Sine and cosine of `r + tail` for `|r| ≤ π/4`, where `tail` is at most an ulp of `r` or both are tiny.
#[inline(always)]
fn kernels<T: Scalar>(r: T, tail: T) -> [T; 2] {
    let one: T = number(1.0);
    let z = r * r;
    let half = number::<T>(0.5) * z;
    // 1 − z/2 rounds; what it lost is recovered exactly below.
    let base = one - half;

    let sine = r + (z * r * horner(z, SIN) + tail * base);
    let cosine = base + (((one - base) - half) + (z * z * horner(z, COS) - r * tail));
    [sine, cosine]
}

#[inline(always)]
fn horner<T: Scalar>(z: T, [c0, c1, c2]: [f32; 3]) -> T {
    number::<T>(c0) + z * (number::<T>(c1) + z * number(c2))
}
