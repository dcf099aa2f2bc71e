//! The machine's own floats.

use crate::Scalar;

macro_rules! machine_float {
    ($float:ident) => {
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
    };
}

machine_float!(f32);
machine_float!(f64);
