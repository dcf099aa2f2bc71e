//! Sine and cosine as plain arithmetic: the same bits on every machine, at the width of the vectors.
//!
//! A platform's `libm` is fast for one value and different from the next platform's. These
//! functions use only `+`, `−`, `×`, bit operations and selects. They have no branch, no table, no
//! conversion between floats and integers and no fused multiply-add, so a lane loop around them
//! vectorises on any instruction set, and each rounding is IEEE 754's own.
//!
//! | function | range | largest error found | arguments tried |
//! | --- | --- | --- | --- |
//! | [`sine64::sin`] | abs(x) ≤ 2²⁰·π/2 ≈ 1.65·10⁶ | 0.787 ulp | 1.6·10⁸ |
//! | [`sine64::cos`] | the same | 0.780 ulp | 1.6·10⁸ |
//! | [`sine32::sin`] | abs(x) ≤ 2¹⁶·π/2 ≈ 1.03·10⁵ | 0.807 ulp | every value |
//! | [`sine32::cos`] | the same | 0.810 ulp | every value |
//!
//! The `f64` errors were measured against binary128 arithmetic, on arguments around the multiples of
//! π/2 and in the octant where the error is largest among others. The tests hold every function to
//! 1 ulp against a correctly rounded oracle.
//!
//! Beyond its range a function returns NaN rather than a wrong number; so it does for infinities
//! and NaN. The NaN is always the same one, bit for bit. Within the range `sin` is odd and `cos`
//! even to the last bit, `sin(-0.0)` is `-0.0`, and no result exceeds 1 in magnitude.
//!
//! **Method.** Cody and Waite's reduction (*Software Manual for the Elementary Functions*, 1980):
//! π/2 is cut into parts so short that `k` times a part is exact, and the parts are subtracted one
//! by one. What the working precision cannot hold of the remainder is kept in a second float. On
//! `[-π/4, π/4]` minimax polynomials give sine and cosine; `k` mod 4 says which, and its sign.
//!
//! On a concrete `f64`, `x.sin()` is the standard library's function. Generic code over
//! [`Elementary`](crate::Elementary) gets the functions of this module.

pub mod sine32;
pub mod sine64;
