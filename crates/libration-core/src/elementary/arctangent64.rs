//! Arc tangent of an `f64`, and the angle of a vector.

use core::f64::consts::SQRT_2;

use super::error_free::{fast_two_sum, quotient, two_sum};

/// `(atan t − t)/t³` as a polynomial in `t²`: minimax for the relative error of the arc tangent on
/// `|t| ≤ √2 − 1`, found by Remez's exchange, its coefficients rounded one after the other. Its error is below
/// 2⁻⁵⁸.
const ATAN: [f64; 11] = [
    -0.333_333_333_333_332,
    0.199_999_999_999_538_16,
    -0.142_857_142_802_235_05,
    0.111_111_107_853_822_99,
    -0.090_908_978_401_968_32,
    0.076_920_623_367_010_83,
    -0.066_631_370_600_422_54,
    0.058_482_003_061_540_166,
    -0.050_410_344_516_476_34,
    0.038_116_736_403_543_28,
    -0.017_972_962_343_855_963,
];

/// 0, π/4, π/2, 3π/4 and π as sums of two floats, their errors below 2⁻¹⁰⁶.
const EIGHTHS: [(f64, f64); 5] = [
    (0.0, 0.0),
    (core::f64::consts::FRAC_PI_4, 3.061_616_997_868_383e-17),
    (core::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17),
    (2.356_194_490_192_345, 9.184_850_993_605_148e-17),
    (core::f64::consts::PI, 1.224_646_799_147_353_2e-16),
];

const SIGN: u64 = 1 << 63;

/// Arc tangent of `x` in radians, within 0.68 ulp.
#[inline(always)]
pub fn atan(x: f64) -> f64 {
    let value = angle(x.abs(), 1.0, false);
    let value = f64::from_bits(value.to_bits() | (x.to_bits() & SIGN));
    if x.is_nan() { f64::NAN } else { value }
}

/// Angle of the vector `(x, y)` in `[−π, π]`, within 0.68 ulp, with the signs of zeros and the values at
/// infinities of C99, annex F.9.1.4.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    let (a, b) = (y.abs(), x.abs());
    // Two infinities count as equal.
    let infinite = (a == f64::INFINITY) & (b == f64::INFINITY);
    let (a, b) = if infinite { (1.0, 1.0) } else { (a, b) };
    // Neither 2⁹⁰⁰ nor what cancels below 2⁻⁹⁰⁰ is good for exact products. The smaller number loses digits
    // only where the quotient vanishes, or where it rounds to the angle anyway.
    let largest = if a > b { a } else { b };
    const UP: f64 = 1.329_227_995_784_916e36;
    let scale = if largest > 8.452_712_498_170_644e270 { 1.0 / UP } else { 1.0 };
    let scale = if largest < 1.183_052_186_166_774_7e-271 { UP } else { scale };

    let value = angle(a * scale, b * scale, x.is_sign_negative());
    let value = f64::from_bits(value.to_bits() | (y.to_bits() & SIGN));
    if x.is_nan() | y.is_nan() { f64::NAN } else { value }
}

/// Angle of the vector `(±b, a)` for `a, b ≥ 0`, not both infinite.
#[inline(always)]
fn angle(a: f64, b: f64, negative: bool) -> f64 {
    // Turn back by 0, π/4 or π/2, so that the tangent of the rest is at most √2 − 1.
    let first = a <= (SQRT_2 - 1.0) * b;
    let last = a > (SQRT_2 + 1.0) * b;
    let (n, d) = if last { ((-b, 0.0), (a, 0.0)) } else { (two_sum(a, -b), two_sum(a, b)) };
    let (n, d) = if first { ((a, 0.0), (b, 0.0)) } else { (n, d) };
    // The angle of the zero vector is 0.
    let d = if d.0 == 0.0 { (1.0, 0.0) } else { d };
    let offset = if last { EIGHTHS[2] } else { EIGHTHS[1] };
    let offset = if first { EIGHTHS[0] } else { offset };
    let mirrored = if last { EIGHTHS[2] } else { EIGHTHS[3] };
    let mirrored = if first { EIGHTHS[4] } else { mirrored };

    let (t, low) = quotient(n, d);
    // The correction of a tiny quotient may be wrong or NaN, and does not count.
    let low = if t.abs() > 1e-10 { low } else { 0.0 };
    let z = t * t;
    let rest = z * t * horner(z, ATAN) + low * (1.0 - z);
    let (offset, t, rest) = if negative { (mirrored, -t, -rest) } else { (offset, t, rest) };
    let (base, lost) = fast_two_sum(offset.0, t);
    base + (lost + (offset.1 + rest))
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10]: [f64; 11]) -> f64 {
    let high = c6 + z * (c7 + z * (c8 + z * (c9 + z * c10)));
    c0 + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * high)))))
}
