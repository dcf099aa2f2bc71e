//! Arc sine and arc cosine of an `f32`, in `f64` arithmetic.
//!
//! In `f32` the root would need a sum of two floats, that is a division and an exact product: more operations
//! than the halved width of the loop around it costs.

use core::f64::consts::{FRAC_PI_2, PI};

/// `(asin s − s)/s³` as a polynomial in `s²`: minimax for the relative error of the arc sine on `|s| ≤ ½`, found
/// by Remez's exchange. Its error is below 2⁻³⁵.
const ASIN: [f64; 7] = [
    0.166_666_671_897_647_25,
    0.074_999_481_561_950_01,
    0.044_660_165_850_589_864,
    0.030_110_197_088_468_37,
    0.024_618_861_366_917_252,
    0.007_467_183_904_932_483,
    0.034_695_737_927_941_09,
];

const SIGN: u32 = 1 << 31;

/// Arc sine of `x` in radians, within 0.51 ulp, NaN outside [−1, 1].
#[inline(always)]
pub fn asin(x: f32) -> f32 {
    let a = x.abs();
    let value = kernel(f64::from(a));
    // asin a = π/2 − 2 asin √((1 − a)/2).
    let value = if a < 0.5 { value } else { FRAC_PI_2 - 2.0 * value } as f32;
    let value = f32::from_bits(value.to_bits() | (x.to_bits() & SIGN));
    if a <= 1.0 { value } else { f32::NAN }
}

/// Arc cosine of `x` in radians, within 0.51 ulp, NaN outside [−1, 1].
#[inline(always)]
pub fn acos(x: f32) -> f32 {
    let a = x.abs();
    let value = kernel(f64::from(a));
    // acos a = 2 asin √((1 − a)/2), or π/2 − asin a; and acos(−a) = π − acos a.
    let value = if a < 0.5 { FRAC_PI_2 - value } else { 2.0 * value };
    let value = if x < 0.0 { PI - value } else { value } as f32;
    if a <= 1.0 { value } else { f32::NAN }
}

/// Arc sine of `a` if `a < ½`, else of `√((1 − a)/2)`.
#[inline(always)]
fn kernel(a: f64) -> f64 {
    let small = a < 0.5;
    let z = if small { a * a } else { 0.5 * (1.0 - a) };
    let s = if small { a } else { z.sqrt() };
    s + z * s * horner(z, ASIN)
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3, c4, c5, c6]: [f64; 7]) -> f64 {
    c0 + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6)))))
}
