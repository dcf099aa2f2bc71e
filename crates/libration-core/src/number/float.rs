//! The floats of the machine.

use crate::elementary::{sine32, sine64};
use crate::{Elementary, Float, Scalar};

macro_rules! machine_float {
    ($float:ident, $name:literal, $sine:ident) => {
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
            fn sin(self) -> Self {
                $sine::sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                $sine::cos(self)
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

machine_float!(f32, "f32", sine32);
machine_float!(f64, "f64", sine64);
