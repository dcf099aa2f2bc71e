//! Floats with a significand of any size.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::{Elementary, Float, Scalar};

/// A float with a significand of `P` bits, the leading one included, and the exponents of an `f64`.
///
/// Every operation is computed in `f64` and rounded to `P` bits at once, to nearest with ties to even. For `+`, `−`,
/// `×`, `÷` and `√` that is the correctly rounded result where `2P + 2 ≤ 53` (Figueroa, *When is double rounding
/// innocuous?*, 1995), that is up to 25 bits; with more bits it may be the other neighbour. So `Mantissa<24>` is an
/// `f32` and `Mantissa<11>` an `f16`, as long as neither overflows or underflows.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Mantissa<const P: u32>(f64);

impl<const P: u32> Mantissa<P> {
    /// `x` with `P` bits.
    #[inline(always)]
    fn rounded(x: f64) -> Self {
        const { assert!(P >= 2 && P <= 53, "a significand has 2 to 53 bits") };
        let dropped = 53 - P;
        if dropped == 0 || !x.is_finite() {
            return Mantissa(x);
        }
        let bits = x.to_bits();
        // Half a unit in the last place that stays, a little less where that place is even.
        let half = (1_u64 << (dropped - 1)) - 1 + (bits >> dropped & 1);
        // What carries over goes into the exponent, where it belongs.
        Mantissa(f64::from_bits((bits + half) >> dropped << dropped))
    }
}

macro_rules! rounded_operation {
    ($($operation:ident $method:ident),*) => {$(
        impl<const P: u32> $operation for Mantissa<P> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Mantissa::rounded($operation::$method(self.0, other.0))
            }
        }
    )*};
}

rounded_operation!(Add add, Sub sub, Mul mul, Div div);

impl<const P: u32> Neg for Mantissa<P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Mantissa(-self.0)
    }
}

impl<const P: u32> Scalar for Mantissa<P> {
    #[inline(always)]
    fn from_f64(c: f64) -> Self {
        Mantissa::rounded(c)
    }
    #[inline(always)]
    fn ratio(self, num: i32, den: i32) -> Self {
        self * Mantissa::rounded(f64::from(num)) / Mantissa::rounded(f64::from(den))
    }
}

/// Functions that `f64` computes, rounded.
macro_rules! rounded_function {
    ($($function:ident($($other:ident)?))*) => {$(
        #[inline(always)]
        fn $function(self $(, $other: Self)?) -> Self {
            Mantissa::rounded(Elementary::$function(self.0 $(, $other.0)?))
        }
    )*};
}

impl<const P: u32> Elementary for Mantissa<P> {
    rounded_function! {
        sqrt() recip() sin() cos() tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh()
        abs() min(other) max(other) signum()
    }

    #[inline(always)]
    fn quotient(self, divisor: Self) -> Self {
        self / divisor
    }
    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self.0 < other.0 { then } else { otherwise }
    }
    #[inline(always)]
    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self.0 == other.0 { then } else { otherwise }
    }
}

impl<const P: u32> Float for Mantissa<P> {
    const NAME: &'static str = "mantissa";
    const UNIT_ROUNDOFF: f64 = 1.0 / (1_u64 << P) as f64;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.0
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::Rk4;
    use crate::system::{Duffing, Pendulum};
    use crate::{Integrator, State};

    #[test]
    fn rounding_is_to_nearest_with_ties_to_even() {
        // With three bits there are 4, 5, 6, 7, 8, 10.
        let three = |x: f64| Mantissa::<3>::from_f64(x).to_f64();
        let found = [4.4, 4.5, 5.5, 6.51, 7.49, 7.5, -4.5, 9.0, 11.0, 0.0].map(three);
        assert_eq!(found, [4.0, 4.0, 6.0, 7.0, 7.0, 8.0, -4.0, 8.0, 12.0, 0.0]);
        assert!(three(f64::NAN).is_nan() && three(f64::INFINITY) == f64::INFINITY);
    }

    #[test]
    fn twenty_four_bits_are_an_f32_and_fifty_three_an_f64_through_a_whole_orbit() {
        // The sine of an f32 has its own kernel, good to 0.81 ulp: this system has none.
        let two = Mantissa::<24>::from_f64(2.0);
        let (system, same) =
            (Duffing { alpha: 2.0_f32, beta: 2.0 }, Duffing { alpha: two, beta: two });
        let mut single = State { q: [1.5_f32], v: [0.25] };
        let mut short = single.map(|x| Mantissa::<24>::from_f64(f64::from(x)));
        for step in 0..10_000 {
            single = Rk4.step(&system, single, 0.01);
            short = Rk4.step(&same, short, Scalar::from_f64(0.01));
            assert_eq!(short.map(Float::to_f64), single.map(f64::from), "{step}");
        }
        let mut double = State { q: [1.5], v: [0.25] };
        let mut long = double.map(Mantissa::<53>::from_f64);
        let pendulum = Pendulum { omega2: 2.0 };
        for step in 0..1000 {
            double = Rk4.step(&pendulum, double, 0.01);
            long =
                Rk4.step(&Pendulum { omega2: Scalar::from_f64(2.0) }, long, Scalar::from_f64(0.01));
            assert_eq!(long.map(Float::to_f64), double, "{step}");
        }
    }
}
