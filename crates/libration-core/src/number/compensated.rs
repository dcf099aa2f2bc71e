//! Single precision with compensated sums.

use core::ops::{Add, Mul, Neg, Sub};

use super::pair::{equal, less};
use crate::{Elementary, Float, Scalar};

/// An `f32`, and the rounding errors of the sums that led to it.
///
/// A sum is the rounded sum of both values, with its rounding error and both low parts kept beside it; a product is
/// that of the values alone. In a step `x + h·y` the increment is then rounded as an `f32` is, which is an error of
/// `u` in something `h` times smaller, while the sum itself loses nothing that could be seen: compensated summation
/// (Kahan, *Further remarks on reducing truncation errors*, CACM 8, 1965; Neumaier, ZAMM 54, 1974; for integrators
/// Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd ed., §VIII.5).
///
/// Constants are `f32`: a product would use no more of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Compensated {
    /// The value rounded to `f32`.
    value: f32,
    /// The compensation: at most half a unit in the last place.
    lost: f32,
}

impl Compensated {
    /// A number with nothing to keep.
    #[inline(always)]
    fn plain(value: f32) -> Self {
        Compensated { value, lost: 0.0 }
    }

    #[inline(always)]
    fn parts(self) -> (f32, f32) {
        (self.value, self.lost)
    }
}

impl Add for Compensated {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // Knuth's sum with its exact error.
        let sum = self.value + other.value;
        let part = sum - self.value;
        let error = (self.value - (sum - part)) + (other.value - part);
        let low = error + (self.lost + other.lost);
        // Dekker's, for a low part that is smaller than the value.
        let value = sum + low;
        Compensated { value, lost: low - (value - sum) }
    }
}

impl Sub for Compensated {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Compensated {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Compensated::plain(self.value * other.value)
    }
}

impl Neg for Compensated {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Compensated { value: -self.value, lost: -self.lost }
    }
}

impl Scalar for Compensated {
    #[inline(always)]
    fn from_f64(c: f64) -> Self {
        Compensated::plain(c as f32)
    }
    #[inline(always)]
    fn ratio(self, num: i32, den: i32) -> Self {
        Compensated::plain(self.value.ratio(num, den))
    }
}

/// Functions of the value, which use nothing of the compensation.
macro_rules! function_of_value {
    ($($function:ident($($other:ident)?))*) => {$(
        #[inline(always)]
        fn $function(self $(, $other: Self)?) -> Self {
            Compensated::plain(Elementary::$function(self.value $(, $other.value)?))
        }
    )*};
}

impl Elementary for Compensated {
    function_of_value! {
        sqrt() recip() sin() cos() tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let value = if less(other.parts(), self.parts()) { other } else { self };
        if self.value.is_nan() | other.value.is_nan() {
            Compensated::plain(f32::NAN)
        } else {
            value
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let value = if less(self.parts(), other.parts()) { other } else { self };
        if self.value.is_nan() | other.value.is_nan() {
            Compensated::plain(f32::NAN)
        } else {
            value
        }
    }
    #[inline(always)]
    fn signum(self) -> Self {
        Compensated::plain(Elementary::signum(self.value))
    }
    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if less(self.parts(), other.parts()) { then } else { otherwise }
    }
    #[inline(always)]
    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        if equal(self.parts(), other.parts()) { then } else { otherwise }
    }
}

impl Float for Compensated {
    const NAME: &'static str = "f32-compensated";

    /// That of its products; sums keep about twice as many digits.
    const UNIT_ROUNDOFF: f64 = f32::UNIT_ROUNDOFF;

    /// The value with what was kept of its sums.
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self.value) + f64::from(self.lost)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.value.is_finite() && self.lost.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_keeps_what_an_f32_rounds_off_and_a_product_does_not_use_it() {
        let tiny = Compensated::from_f64(2.0_f64.powi(-40));
        let sum = Compensated::one() + tiny;
        assert_eq!(sum.to_f64(), 1.0 + 2.0_f64.powi(-40));
        assert_eq!((sum - Compensated::one()), tiny);
        assert_eq!((sum * sum).to_f64(), 1.0);
        assert!(sum > Compensated::one() && -sum < Compensated::zero());
    }

    #[test]
    fn a_million_tenths_are_a_hundred_thousand() {
        let tenth = Compensated::from_f64(0.1);
        let sum = (0..1_000_000).fold(Compensated::zero(), |sum, _| sum + tenth);
        // The tenth itself is an f32. A sum rounds what it keeps to 24 bits, 2⁻²⁴ of half a unit of the last place
        // of 10⁵, a million times at most.
        let error = sum.to_f64() - 1e6 * f64::from(0.1_f32);
        assert!(error.abs() < 1e6 * 1e5 * 2.0_f64.powi(-48), "{error}");
        let plain = (0..1_000_000).fold(0.0_f32, |sum, _| sum + 0.1);
        assert!((plain - 1e5).abs() > 900.0, "{plain}");
    }

    #[test]
    fn what_overflows_is_not_finite() {
        let huge = Compensated::from_f64(3e38);
        assert!(huge.is_finite() && !(huge + huge).is_finite() && !(huge * huge).is_finite());
    }
}
