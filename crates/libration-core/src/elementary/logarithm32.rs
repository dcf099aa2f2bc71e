//! Natural logarithm of an `f32`, in `f32` arithmetic throughout.

use core::f32::consts::FRAC_1_SQRT_2;

/// ln 2 as a sum of two parts, its error below 2⁻⁴⁵. The first is a multiple of 2⁻¹⁵: its product with an
/// integer of 8 bits is exact.
const LN_2: [f32; 2] = [0.693_145_75, 1.428_606_8e-6];

/// `(2 atanh s − 2s)/s³` as a polynomial in `s²`: minimax for the relative error on `|s| ≤ (√2 − 1)/(√2 + 1)`,
/// found by Remez's exchange, its coefficients rounded one after the other. The error of `2 atanh s` is below
/// 2⁻³⁰.
const ATANH: [f32; 3] = [0.666_667_76, 0.399_775_83, 0.298_708_17];

/// 2²⁵, which makes the subnormal numbers normal.
const UP: f32 = 33_554_432.0;

const SIGNIFICAND: u32 = (1 << 23) - 1;

/// `ln x`, within 0.73 ulp; −∞ for zeros, NaN below.
#[inline(always)]
pub fn ln(x: f32) -> f32 {
    let subnormal = x < f32::MIN_POSITIVE;
    let (k, m) = split(if subnormal { x * UP } else { x });
    let k = k - if subnormal { 25.0 } else { 0.0 };

    // Exact, by Sterbenz's lemma.
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let half_square = 0.5 * f * f;
    // ln(1 + f) = f − f²/2 + s (f²/2 + R) with R = (2 atanh s − 2s)/s, as in fdlibm's `e_log.c`.
    let series = z * (ATANH[0] + z * (ATANH[1] + z * ATANH[2]));
    let rest = k * LN_2[1] + s * (half_square + series);
    let (sum, first_lost) = fast_two_sum(k * LN_2[0], f);
    let (sum, second_lost) = fast_two_sum(sum, -half_square);
    let value = sum + ((first_lost + second_lost) + rest);

    let value = if x == f32::INFINITY { x } else { value };
    let value = if x == 0.0 { f32::NEG_INFINITY } else { value };
    if x >= 0.0 { value } else { f32::NAN }
}

/// `a + b` as rounded sum and rounding error for `|a| ≥ |b|` or `a = 0` (Dekker's Fast2Sum).
#[inline(always)]
fn fast_two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// `x = 2ᵏ·m` with `√½ ≤ m < √2`, for a normal positive `x`.
#[inline(always)]
fn split(x: f32) -> (f32, f32) {
    let shifted = x.to_bits().wrapping_add(1.0_f32.to_bits() - FRAC_1_SQRT_2.to_bits());
    // An integer below 2²³ in the low bits of 2²³ is their sum.
    const TWO_TO_23: f32 = 8_388_608.0;
    let k = f32::from_bits(TWO_TO_23.to_bits() | shifted >> 23) - (TWO_TO_23 + 127.0);
    (k, f32::from_bits((shifted & SIGNIFICAND).wrapping_add(FRAC_1_SQRT_2.to_bits())))
}
