//! Arc tangent of an `f32`, and the angle of a vector, in `f64` arithmetic.
//!
//! In `f32` the quotient would need a sum of two floats, that is a second division and exact products: more
//! operations than the halved width of the loop around it costs.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, SQRT_2};

/// `(atan t − t)/t³` as a polynomial in `t²`: minimax for the relative error of the arc tangent on
/// `|t| ≤ √2 − 1`, found by Remez's exchange. Its error is below 2⁻³⁵.
const ATAN: [f64; 6] = [
    -0.333_333_325_155_735_3,
    0.199_999_052_258_432_7,
    -0.142_820_426_503_715_87,
    0.110_450_970_908_315_3,
    -0.084_784_090_419_592_13,
    0.047_482_451_674_335_61,
];

const SIGN: u32 = 1 << 31;

/// Arc tangent of `x` in radians, within 0.51 ulp.
#[inline(always)]
pub fn atan(x: f32) -> f32 {
    let value = angle(f64::from(x.abs()), 1.0) as f32;
    let value = f32::from_bits(value.to_bits() | (x.to_bits() & SIGN));
    if x.is_nan() { f32::NAN } else { value }
}

/// Angle of the vector `(x, y)` in `[−π, π]`, within 0.51 ulp, with the signs of zeros and the values at
/// infinities of C99, annex F.9.1.4.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (a, b) = (y.abs(), x.abs());
    // Two infinities count as equal.
    let infinite = (a == f32::INFINITY) & (b == f32::INFINITY);
    let (a, b) = if infinite { (1.0, 1.0) } else { (a, b) };
    let value = angle(f64::from(a), f64::from(b));
    let value = if x.is_sign_negative() { PI - value } else { value } as f32;
    let value = f32::from_bits(value.to_bits() | (y.to_bits() & SIGN));
    if x.is_nan() | y.is_nan() { f32::NAN } else { value }
}

/// Angle of the vector `(b, a)` for `a, b ≥ 0`, not both infinite.
#[inline(always)]
fn angle(a: f64, b: f64) -> f64 {
    // Turn back by 0, π/4 or π/2, so that the tangent of the rest is at most √2 − 1.
    let first = a <= (SQRT_2 - 1.0) * b;
    let last = a > (SQRT_2 + 1.0) * b;
    let (offset, n, d) = if last { (FRAC_PI_2, -b, a) } else { (FRAC_PI_4, a - b, a + b) };
    let (offset, n, d) = if first { (0.0, a, b) } else { (offset, n, d) };
    // The angle of the zero vector is 0.
    let t = n / if d == 0.0 { 1.0 } else { d };
    let z = t * t;
    offset + (t + z * t * horner(z, ATAN))
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3, c4, c5]: [f64; 6]) -> f64 {
    c0 + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * c5))))
}
