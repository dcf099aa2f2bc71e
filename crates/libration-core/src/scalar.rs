//! The arithmetic that an integrator may use, and no more.

use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

/// A number on which an integrator can run: `+`, `-`, `*`, negation and constants.
///
/// There is no division, no comparison and no way back to `f64`. That is what lets one
/// definition of a step serve floats, derivatives and polynomials alike.
pub trait Scalar:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// The constant `c`, rounded to this type if it must be.
    fn from_f64(c: f64) -> Self;

    /// `self · num / den`, with one rounding for each operation; exact types stay exact.
    ///
    /// It is not `self · (num/den)`: a textbook's `dt / 6` is a division, and the bits differ.
    fn ratio(self, num: i32, den: i32) -> Self;

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::from_f64(1.0)
    }
}

/// A scalar with the elementary functions that nonlinear systems need.
///
/// The float versions are branch-free arithmetic: they vectorise with the loop around them and
/// give the same bits on every machine, neither of which is true of a platform's `libm`. Their ranges,
/// errors and special values are in the documentation of [`elementary`](crate::elementary).
pub trait Elementary: Scalar {
    /// Square root.
    fn sqrt(self) -> Self;
    /// Reciprocal.
    fn recip(self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Tangent of an angle in radians.
    fn tan(self) -> Self;
    /// Arc sine in radians, undefined outside `[−1, 1]`.
    fn asin(self) -> Self;
    /// Arc cosine in radians, undefined outside `[−1, 1]`.
    fn acos(self) -> Self;
    /// Arc tangent in radians.
    fn atan(self) -> Self;
    /// Angle of the vector `(x, self)` in `[−π, π]`, in radians.
    fn atan2(self, x: Self) -> Self;
    /// Exponential function.
    fn exp(self) -> Self;
    /// Natural logarithm, undefined below zero.
    fn ln(self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The lesser of two numbers; NaN if either is NaN.
    fn min(self, other: Self) -> Self;
    /// The greater of two numbers; NaN if either is NaN.
    fn max(self, other: Self) -> Self;
    /// −1, 0 or 1, with the sign of this number; a zero is returned as it is, NaN as NaN.
    fn signum(self) -> Self;
    /// `then` if `self < other`, else `otherwise`, also if either is NaN.
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self;
    /// `then` if `self == other`, else `otherwise`, also if either is NaN.
    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self;

    /// `self / divisor`, of floats with one rounding.
    #[inline(always)]
    fn quotient(self, divisor: Self) -> Self {
        self * divisor.recip()
    }

    /// `then` if `self ≤ other`, else `otherwise`, also if either is NaN.
    #[inline(always)]
    fn select_less_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        self.select_less(other, then, self.select_equal(other, then, otherwise))
    }
}

/// A scalar whose value can be looked at: a float, whatever its width.
pub trait Float: Elementary + PartialOrd + Send + Sync + 'static {
    /// Name on the command line and in reports, as in `f32`.
    const NAME: &'static str;

    /// Unit roundoff `u`: half the distance from 1 to the next larger number.
    const UNIT_ROUNDOFF: f64;

    /// The value as `f64`, rounded if this type is wider.
    fn to_f64(self) -> f64;

    /// Whether the value is neither infinite nor NaN.
    fn is_finite(self) -> bool;
}
