//! The 16-bit floats, `f16` (IEEE 754 binary16) and `bf16` (bfloat16).
//!
//! Every operation is computed in `f32` and rounded to 16 bits at once. For `+`, `−`, `×`, `÷` and `√`
//! that is the correctly rounded result: rounding first to `q` bits and then to `p` does no harm if
//! `q ≥ 2p + 2` (Figueroa, *When is double rounding innocuous?*, 1995), and `f32` has `q = 24`,
//! `f16` has `p = 11` and `bf16` has `p = 8`.
//!
//! The other elementary functions are those of `f64`, rounded once, which is correct for every argument: the
//! exhaustive test finds no value near enough to a tie. Their ranges are in [`elementary`](crate::elementary).

use half::{bf16, f16};

use crate::{Elementary, Float, Scalar};

/// `c` in `f32`, the inexact results rounded to the neighbour with an odd significand.
///
/// Rounding to odd keeps the fact that bits were lost, so a second rounding to 16 bits gives what
/// one rounding from `f64` would give. `half`'s own `from_f64` does not: it goes through a rounded
/// `f32` where the processor has F16C, and elsewhere it drops the low 32 bits unseen.
#[inline(always)]
fn to_odd(c: f64) -> f32 {
    let nearest = c as f32;
    let lost = c - f64::from(nearest);
    let bits = nearest.to_bits();
    if lost == 0.0 || lost.is_nan() || bits & 1 == 1 {
        nearest
    } else if (lost > 0.0) == (c > 0.0) {
        f32::from_bits(bits + 1)
    } else {
        f32::from_bits(bits - 1)
    }
}

/// Functions that `f64` computes and a conversion rounds.
macro_rules! in_f64 {
    ($($function:ident($($other:ident)?))*) => {$(
        #[inline(always)]
        fn $function(self $(, $other: Self)?) -> Self {
            Scalar::from_f64(Elementary::$function(self.to_f64() $(, $other.to_f64())?))
        }
    )*};
}

macro_rules! half_float {
    ($float:ident, $name:literal, $unit_roundoff:expr) => {
        impl Scalar for $float {
            #[inline(always)]
            fn from_f64(c: f64) -> Self {
                $float::from_f32(to_odd(c))
            }
            #[inline(always)]
            fn ratio(self, num: i32, den: i32) -> Self {
                self * $float::from_f32(num as f32) / $float::from_f32(den as f32)
            }
        }

        impl Elementary for $float {
            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::from_f32(self.to_f32().sqrt())
            }
            #[inline(always)]
            fn recip(self) -> Self {
                $float::from_f32(self.to_f32().recip())
            }
            #[inline(always)]
            fn quotient(self, divisor: Self) -> Self {
                self / divisor
            }
            in_f64! {
                sin() cos() tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh()
                abs() min(other) max(other) signum()
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
            const UNIT_ROUNDOFF: f64 = $unit_roundoff;

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self.to_f32())
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
        }
    };
}

half_float!(f16, "f16", 1.0 / 2048.0);
half_float!(bf16, "bf16", 1.0 / 256.0);
