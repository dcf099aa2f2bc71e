//! Hyperbolic sine, cosine and tangent of an `f32`, in `f64` arithmetic.
//!
//! In `f32` the differences of exponentials would need a sum of two floats for each term, and more operations
//! than the halved width of the loop around them costs.

use core::f64::consts::{LN_2, LOG2_E};

use super::exponential64::power_of_two;

/// Adding 1.5·2⁵² leaves no room for a fraction: it rounds to the nearest integer.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// `(cosh r − 1 − r²/2)/r⁴` as a polynomial in `r²`: minimax on `[-ln 2 / 2, ln 2 / 2]`, found by Remez's
/// exchange. The error of cosh is below 2⁻⁴⁵.
const COSH: [f64; 3] =
    [0.041_666_666_814_830_58, 0.001_388_883_053_043_227_2, 2.487_290_549_233_680_4e-5];

/// `(sinh r − r)/r³` as a polynomial in `r²`, found in the same way. The relative error of sinh is below
/// 2⁻³⁷.
const SINH: [f64; 3] =
    [0.166_666_667_545_366_4, 0.008_333_288_959_130_25, 0.000_199_049_581_835_207_45];

const SIGN: u32 = 1 << 31;

/// `sinh x`, within 0.51 ulp; infinite above 89.41 in magnitude.
#[inline(always)]
pub fn sinh(x: f32) -> f32 {
    signed(twice(x, 90.0).0 * 0.5, x)
}

/// `cosh x`, within 0.51 ulp; infinite above 89.41 in magnitude.
#[inline(always)]
pub fn cosh(x: f32) -> f32 {
    let value = (twice(x, 90.0).1 * 0.5) as f32;
    if x.is_nan() { f32::NAN } else { value }
}

/// `tanh x`, within 0.51 ulp; ±1 above 9.01 in magnitude.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    let (sinh, cosh) = twice(x, 10.0);
    signed(sinh / cosh, x)
}

/// `magnitude` with the sign of `x`; NaN if `x` is.
#[inline(always)]
fn signed(magnitude: f64, x: f32) -> f32 {
    let value = f32::from_bits((magnitude as f32).to_bits() | (x.to_bits() & SIGN));
    if x.is_nan() { f32::NAN } else { value }
}

/// Twice the hyperbolic sine and cosine of `|x|`, or of `largest` if that is less.
#[inline(always)]
fn twice(x: f32, largest: f32) -> (f64, f64) {
    let a = x.abs();
    let a = f64::from(if a > largest { largest } else { a });
    let k = (a * LOG2_E + ROUNDER) - ROUNDER;
    let r = a - k * LN_2;

    let z = r * r;
    let cosh = 1.0 + z * (0.5 + z * (COSH[0] + z * (COSH[1] + z * COSH[2])));
    let sinh = r + z * r * (SINH[0] + z * (SINH[1] + z * SINH[2]));
    let (up, down) = (power_of_two(k), power_of_two(-k));
    let (sum, difference) = (up + down, up - down);
    (difference * cosh + sum * sinh, sum * cosh + difference * sinh)
}
