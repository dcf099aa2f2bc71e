//! Elementary functions as plain arithmetic: the same bits on every machine, at the width of the vectors.
//!
//! A platform's `libm` is fast for one value and different from the next platform's. These
//! functions use only `+`, `−`, `×`, `÷`, `√`, bit operations and selects. They have no branch, no table, no
//! conversion between floats and integers and no fused multiply-add, so a lane loop around them
//! vectorises on any instruction set, and each rounding is IEEE 754's own.
//!
//! | function | range | largest error found | arguments tried |
//! | --- | --- | --- | --- |
//! | [`sine64::sin`] | abs(x) ≤ 2²⁰·π/2 ≈ 1.65·10⁶ | 0.787 ulp | 1.6·10⁸ |
//! | [`sine64::cos`] | the same | 0.780 ulp | 1.6·10⁸ |
//! | [`tangent64::tan`] | the same | 0.863 ulp | 1.6·10⁷ |
//! | [`arcsine64::asin`] | abs(x) ≤ 1 | 0.645 ulp | 2.4·10⁷ |
//! | [`arcsine64::acos`] | abs(x) ≤ 1 | 0.629 ulp | 2.4·10⁷ |
//! | [`arctangent64::atan`] | all | 0.656 ulp | 2.4·10⁷ |
//! | [`arctangent64::atan2`] | all | 0.664 ulp | 2.4·10⁷ |
//! | [`exponential64::exp`] | all | 0.606 ulp, 0.751 subnormal | 2.4·10⁷ |
//! | [`logarithm64::ln`] | x ≥ 0 | 0.657 ulp | 2.4·10⁷ |
//! | [`hyperbolic64::sinh`] | all | 0.725 ulp | 2.4·10⁷ |
//! | [`hyperbolic64::cosh`] | all | 0.675 ulp | 2.4·10⁷ |
//! | [`hyperbolic64::tanh`] | all | 0.722 ulp | 2.4·10⁷ |
//! | [`sine32::sin`] | abs(x) ≤ 2¹⁶·π/2 ≈ 1.03·10⁵ | 0.807 ulp | every value |
//! | [`sine32::cos`] | the same | 0.810 ulp | every value |
//! | [`tangent32::tan`] | the same | 0.5001 ulp | every value |
//! | [`arcsine32::asin`] | abs(x) ≤ 1 | 0.5003 ulp | every value |
//! | [`arcsine32::acos`] | abs(x) ≤ 1 | 0.5003 ulp | every value |
//! | [`arctangent32::atan`] | all | 0.5004 ulp | every value |
//! | [`arctangent32::atan2`] | all | 0.5004 ulp | 3·10⁶ |
//! | [`exponential32::exp`] | all | 0.609 ulp, 0.754 subnormal | every value |
//! | [`logarithm32::ln`] | x ≥ 0 | 0.719 ulp | every value |
//! | [`hyperbolic32::sinh`] | all | 0.5001 ulp | every value |
//! | [`hyperbolic32::cosh`] | all | 0.5001 ulp | every value |
//! | [`hyperbolic32::tanh`] | all | 0.5001 ulp | every value |
//!
//! The errors of sine and cosine of `f64` were measured against binary128 arithmetic, on arguments around the
//! multiples of π/2 and in the octant where the error is largest among others; those of the other functions of
//! `f64` against double-double arithmetic, those of `f32` against CORE-MATH. The tests hold every function to
//! its error, or to 1 ulp against a correctly rounded oracle.
//!
//! Beyond its range a function returns NaN rather than a wrong number; so it does for NaN, and sine, cosine and
//! tangent do so for infinities. The NaN is always the same one, bit for bit. Overflow gives infinity, and
//! subnormal results are rounded twice. The values at zeros and infinities are those of C99, annex F.9. Odd
//! functions are odd and even ones even to the last bit; `sin(-0.0)` is `-0.0`, and no sine or cosine exceeds 1 in
//! magnitude.
//!
//! **Method.** Cody and Waite's reduction (*Software Manual for the Elementary Functions*, 1980):
//! a constant (π/2, ln 2) is cut into parts so short that `k` times a part is exact, and the parts are subtracted
//! one by one. What the working precision cannot hold of the remainder is kept in a second float. The inverse
//! functions reduce by addition theorems. On the remaining interval minimax polynomials give the function. The last
//! sum adds a large part, whose rounding error is known, and small ones.
//!
//! On a concrete `f64`, `x.sin()` is the standard library's function. Generic code over
//! [`Elementary`](crate::Elementary) gets the functions of this module.

pub mod arcsine32;
pub mod arcsine64;
pub mod arctangent32;
pub mod arctangent64;
pub(crate) mod error_free;
pub mod exponential32;
pub mod exponential64;
pub mod hyperbolic32;
pub mod hyperbolic64;
pub mod logarithm32;
pub mod logarithm64;
pub mod sine32;
pub mod sine64;
pub mod tangent32;
pub mod tangent64;
