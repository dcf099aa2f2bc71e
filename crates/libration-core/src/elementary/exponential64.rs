//! Exponential function of an `f64`.

use core::f64::consts::LOG2_E;

use super::error_free::fast_two_sum;

/// Adding 1.5·2⁵² leaves no room for a fraction: it rounds to the nearest integer, whose low bits
/// are then the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// ln 2 as a sum of two parts, its error below 2⁻⁹⁸. The first is a multiple of 2⁻⁴²: its product with an
/// integer of 11 bits is exact.
const LN_2: [f64; 2] = [0.693_147_180_559_890_3, 5.497_923_018_708_371e-14];

/// `(cosh r − 1 − r²/2)/r⁴` as a polynomial in `r²`: minimax on `[-ln 2 / 2, ln 2 / 2]`, found by Remez's
/// exchange, its coefficients rounded one after the other. The error of cosh is below 2⁻⁷⁰.
const COSH: [f64; 5] = [
    0.041_666_666_666_666_685,
    0.001_388_888_888_887_328_3,
    2.480_158_734_919_984_3e-5,
    2.755_725_182_698_780_4e-7,
    2.092_176_494_298_979_6e-9,
];

/// `(sinh r − r)/r³` as a polynomial in `r²`, found in the same way. The relative error of sinh is below
/// 2⁻⁶¹.
const SINH: [f64; 5] = [
    0.166_666_666_666_666_77,
    0.008_333_333_333_321_386,
    0.000_198_412_698_868_118_08,
    2.755_724_348_108_696_3e-6,
    2.510_929_698_575_990_6e-8,
];

/// `e^x`, within 0.62 ulp, or 0.76 among the subnormal numbers; ∞ above 709.78, subnormal below −708.4 and 0 below −745.13.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    // The exponentials of the limits are ∞ and 0. NaN passes both comparisons.
    let capped = if x > 710.0 { 710.0 } else { x };
    let capped = if capped < -746.0 { -746.0 } else { capped };
    let (k, r, tail) = reduce(capped);
    let (even, odd) = kernels(r);

    let (base, lost) = fast_two_sum(1.0, r);
    let value = base + (lost + (even + (odd + tail * base)));
    // 2ᵏ may be beyond the range where the result is not: two factors, of which only the last rounds.
    let half = (0.5 * k + ROUNDER) - ROUNDER;
    let value = value * power_of_two(half) * power_of_two(k - half);
    if x.is_nan() { f64::NAN } else { value }
}

/// The integer `k` nearest to `x / ln 2` and `x − k·ln 2` as an unevaluated sum, for `|k| < 2¹¹`.
#[inline(always)]
pub(super) fn reduce(x: f64) -> (f64, f64, f64) {
    let k = (x * LOG2_E + ROUNDER) - ROUNDER;
    // Exact, by Sterbenz's lemma unless k is 0.
    let r = x - k * LN_2[0];
    let low = k * LN_2[1];
    let head = r - low;
    (k, head, (r - head) - low)
}

/// `2ᵏ` for an integer `k` from −1022 to 1023.
#[inline(always)]
pub(super) fn power_of_two(k: f64) -> f64 {
    f64::from_bits((k + ROUNDER).to_bits().wrapping_add(1023) << 52)
}

/// `cosh r − 1` and `sinh r − r` for `|r| ≤ ln 2 / 2`.
#[inline(always)]
pub(super) fn kernels(r: f64) -> (f64, f64) {
    let z = r * r;
    (0.5 * z + z * z * horner(z, COSH), z * r * horner(z, SINH))
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3, c4]: [f64; 5]) -> f64 {
    c0 + z * (c1 + z * (c2 + z * (c3 + z * c4)))
}
