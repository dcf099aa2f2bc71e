//! The floats of the machine.

use crate::elementary::{
    arcsine32, arcsine64, arctangent32, arctangent64, exponential32, exponential64, hyperbolic32,
    hyperbolic64, logarithm32, logarithm64, sine32, sine64, tangent32, tangent64,
};
use crate::{Elementary, Float, Scalar};

macro_rules! machine_float {
    ($float:ident, $name:literal, $sine:ident, $tangent:ident, $arcsine:ident, $arctangent:ident,
     $exponential:ident, $logarithm:ident, $hyperbolic:ident) => {
        impl Scalar for $float {
            #[inline(always)]
            fn from_f64(c: f64) -> Self {
                c as $float
            }
            #[inline(always)]
            fn ratio(self, num: i32, den: i32) -> Self {
                self * num as $float / den as $float
            }
        }

        impl Elementary for $float {
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline(always)]
            fn recip(self) -> Self {
                1.0 / self
            }
            #[inline(always)]
            fn quotient(self, divisor: Self) -> Self {
                self / divisor
            }
            #[inline(always)]
            fn sin(self) -> Self {
                $sine::sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                $sine::cos(self)
            }
            #[inline(always)]
            fn tan(self) -> Self {
                $tangent::tan(self)
            }
            #[inline(always)]
            fn asin(self) -> Self {
                $arcsine::asin(self)
            }
            #[inline(always)]
            fn acos(self) -> Self {
                $arcsine::acos(self)
            }
            #[inline(always)]
            fn atan(self) -> Self {
                $arctangent::atan(self)
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                $arctangent::atan2(self, x)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exponential::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $logarithm::ln(self)
            }
            #[inline(always)]
            fn sinh(self) -> Self {
                $hyperbolic::sinh(self)
            }
            #[inline(always)]
            fn cosh(self) -> Self {
                $hyperbolic::cosh(self)
            }
            #[inline(always)]
            fn tanh(self) -> Self {
                $hyperbolic::tanh(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // Of two equal numbers one choice has either: they differ for zeros, where the sign bit is kept.
                let first = if self < other { self } else { other };
                let second = if other < self { other } else { self };
                let value = $float::from_bits(first.to_bits() | second.to_bits());
                if self.is_nan() | other.is_nan() { $float::NAN } else { value }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                let first = if self > other { self } else { other };
                let second = if other > self { other } else { self };
                let value = $float::from_bits(first.to_bits() & second.to_bits());
                if self.is_nan() | other.is_nan() { $float::NAN } else { value }
            }
            #[inline(always)]
            fn signum(self) -> Self {
                let one: $float = 1.0;
                let value = if self == 0.0 { self } else { one.copysign(self) };
                if self.is_nan() { $float::NAN } else { value }
            }
            #[inline(always)]
            fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
                if self < other { then } else { otherwise }
            }
            #[inline(always)]
            fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
                if self == other { then } else { otherwise }
            }
        }

        impl Float for $float {
            const NAME: &'static str = $name;
            const UNIT_ROUNDOFF: f64 = $float::EPSILON as f64 / 2.0;

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
        }
    };
}

machine_float!(
    f32,
    "f32",
    sine32,
    tangent32,
    arcsine32,
    arctangent32,
    exponential32,
    logarithm32,
    hyperbolic32
);
machine_float!(
    f64,
    "f64",
    sine64,
    tangent64,
    arcsine64,
    arctangent64,
    exponential64,
    logarithm64,
    hyperbolic64
);
