//! Natural logarithm of an `f64`.

use core::f64::consts::FRAC_1_SQRT_2;

use super::error_free::{fast_two_sum, two_product};

/// ln 2 as a sum of two parts, its error below 2⁻⁹⁸. The first is a multiple of 2⁻⁴²: its product with an
/// integer of 11 bits is exact.
const LN_2: [f64; 2] = [0.693_147_180_559_890_3, 5.497_923_018_708_371e-14];

/// `(2 atanh s − 2s)/s³` as a polynomial in `s²`: minimax for the relative error on `|s| ≤ (√2 − 1)/(√2 + 1)`,
/// found by Remez's exchange, its coefficients rounded one after the other. The error of `2 atanh s` is below
/// 2⁻⁵⁹.
const ATANH: [f64; 7] = [
    0.666_666_666_666_673_4,
    0.399_999_999_994_165_13,
    0.285_714_287_420_903_55,
    0.222_221_985_952_286_45,
    0.181_835_635_279_942_12,
    0.153_140_636_718_848_12,
    0.147_958_800_994_150_93,
];

/// 2⁵⁴, which makes the subnormal numbers normal.
const UP: f64 = 18_014_398_509_481_984.0;

const SIGNIFICAND: u64 = (1 << 52) - 1;

/// `ln x`, within 0.67 ulp; −∞ for zeros, NaN below.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    let subnormal = x < f64::MIN_POSITIVE;
    let (k, m) = split(if subnormal { x * UP } else { x });
    let k = k - if subnormal { 54.0 } else { 0.0 };

    // Exact, by Sterbenz's lemma.
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let (square, square_low) = two_product(f, f);
    let half_square = 0.5 * square;
    // ln(1 + f) = f − f²/2 + s (f²/2 + R) with R = (2 atanh s − 2s)/s, as in fdlibm's `e_log.c`.
    let rest = s * (half_square + z * horner(z, ATANH)) - 0.5 * square_low;
    let (sum, first_lost) = fast_two_sum(k * LN_2[0], f);
    let (sum, second_lost) = fast_two_sum(sum, -half_square);
    let value = sum + ((first_lost + second_lost) + (k * LN_2[1] + rest));

    let value = if x == f64::INFINITY { x } else { value };
    let value = if x == 0.0 { f64::NEG_INFINITY } else { value };
    if x >= 0.0 { value } else { f64::NAN }
}

/// `x = 2ᵏ·m` with `√½ ≤ m < √2`, for a normal positive `x`.
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    let shifted = x.to_bits().wrapping_add(1.0_f64.to_bits() - FRAC_1_SQRT_2.to_bits());
    // An integer below 2⁵² in the low bits of 2⁵² is their sum.
    const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
    let k = f64::from_bits(TWO_TO_52.to_bits() | shifted >> 52) - (TWO_TO_52 + 1023.0);
    (k, f64::from_bits((shifted & SIGNIFICAND).wrapping_add(FRAC_1_SQRT_2.to_bits())))
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3, c4, c5, c6]: [f64; 7]) -> f64 {
    c0 + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6)))))
}
