//! Sine and cosine as plain arithmetic: the same bits on every machine, at the width of the vectors.
//!
//! A platform's `libm` is fast for one value and different from the next platform's. These
//! functions use only `+`, `−`, `×`, bit operations and selects. They have no branch, no table, no
//! conversion between floats and integers and no fused multiply-add, so a lane loop around them
//! vectorises on any instruction set, and each rounding is IEEE 754's own.
//!
//! | function | range | largest error found | points tried |
//! | --- | --- | --- | --- |
//! | [`sine64::sin`] | abs(x) ≤ 2²⁰·π/2 ≈ 1.6·10⁶ | TODO ulp | TODO |
//! | [`sine64::cos`] | the same | TODO ulp | TODO |
//! | [`sine32::sin`] | abs(x) ≤ 2¹⁶·π/2 ≈ 1.0·10⁵ | TODO ulp | every value |
//! | [`sine32::cos`] | the same | TODO ulp | every value |
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
