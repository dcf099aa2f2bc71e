//! Special values of functions of one argument after IEEE 754 and C99, annex F.9.

use libration::Elementary;

/// A function and its values, bit for bit.
type Values<'a, T> = (&'a str, fn(T) -> T, &'a [(T, T)]);

macro_rules! special_values {
    ($name:ident, $float:ident) => {
        #[test]
        fn $name() {
            use std::$float::consts::{FRAC_PI_2, FRAC_PI_4, PI};
            const INF: $float = $float::INFINITY;
            const NAN: $float = $float::NAN;
            const MAX: $float = $float::MAX;
            // The smallest subnormal and the smallest normal number.
            const TINY: $float = $float::from_bits(1);
            const NORMAL: $float = $float::MIN_POSITIVE;
            let beyond = 1.0 + $float::EPSILON;
            // Those that are undefined give the one NaN for the other.
            let functions: [Values<$float>; 12] = [
                (
                    "exp",
                    Elementary::exp,
                    &[
                        (0.0, 1.0),
                        (-0.0, 1.0),
                        (TINY, 1.0),
                        (INF, INF),
                        (MAX, INF),
                        (-INF, 0.0),
                        (-MAX, 0.0),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "ln",
                    Elementary::ln,
                    &[
                        (1.0, 0.0),
                        (0.0, -INF),
                        (-0.0, -INF),
                        (INF, INF),
                        (-TINY, NAN),
                        (-1.0, NAN),
                        (-INF, NAN),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "tan",
                    Elementary::tan,
                    &[
                        (0.0, 0.0),
                        (-0.0, -0.0),
                        (TINY, TINY),
                        (-TINY, -TINY),
                        (NORMAL, NORMAL),
                        (INF, NAN),
                        (-INF, NAN),
                        (MAX, NAN),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "asin",
                    Elementary::asin,
                    &[
                        (0.0, 0.0),
                        (-0.0, -0.0),
                        (TINY, TINY),
                        (-TINY, -TINY),
                        (1.0, FRAC_PI_2),
                        (-1.0, -FRAC_PI_2),
                        (beyond, NAN),
                        (-beyond, NAN),
                        (INF, NAN),
                        (-INF, NAN),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "acos",
                    Elementary::acos,
                    &[
                        (1.0, 0.0),
                        (-1.0, PI),
                        (0.0, FRAC_PI_2),
                        (-0.0, FRAC_PI_2),
                        (TINY, FRAC_PI_2),
                        (beyond, NAN),
                        (-beyond, NAN),
                        (INF, NAN),
                        (-INF, NAN),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "atan",
                    Elementary::atan,
                    &[
                        (0.0, 0.0),
                        (-0.0, -0.0),
                        (TINY, TINY),
                        (-TINY, -TINY),
                        (1.0, FRAC_PI_4),
                        (-1.0, -FRAC_PI_4),
                        (MAX, FRAC_PI_2),
                        (INF, FRAC_PI_2),
                        (-INF, -FRAC_PI_2),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "sinh",
                    Elementary::sinh,
                    &[
                        (0.0, 0.0),
                        (-0.0, -0.0),
                        (TINY, TINY),
                        (-TINY, -TINY),
                        (MAX, INF),
                        (-MAX, -INF),
                        (INF, INF),
                        (-INF, -INF),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "cosh",
                    Elementary::cosh,
                    &[
                        (0.0, 1.0),
                        (-0.0, 1.0),
                        (TINY, 1.0),
                        (MAX, INF),
                        (-MAX, INF),
                        (INF, INF),
                        (-INF, INF),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "tanh",
                    Elementary::tanh,
                    &[
                        (0.0, 0.0),
                        (-0.0, -0.0),
                        (TINY, TINY),
                        (-TINY, -TINY),
                        (MAX, 1.0),
                        (-MAX, -1.0),
                        (INF, 1.0),
                        (-INF, -1.0),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "abs",
                    Elementary::abs,
                    &[
                        (0.0, 0.0),
                        (-0.0, 0.0),
                        (-TINY, TINY),
                        (-INF, INF),
                        (2.0, 2.0),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                (
                    "signum",
                    Elementary::signum,
                    &[
                        (0.0, 0.0),
                        (-0.0, -0.0),
                        (-TINY, -1.0),
                        (TINY, 1.0),
                        (INF, 1.0),
                        (-INF, -1.0),
                        (NAN, NAN),
                        (-NAN, NAN),
                    ],
                ),
                ("sqrt", Elementary::sqrt, &[(0.0, 0.0), (-0.0, -0.0), (4.0, 2.0), (INF, INF)]),
            ];
            for (name, function, values) in functions {
                for &(x, value) in values {
                    let found = function(std::hint::black_box(x));
                    assert_eq!(found.to_bits(), value.to_bits(), "{name} of {x:e} is {found:e}");
                }
            }
        }
    };
}

special_values!(functions_of_an_f64_have_the_special_values_of_ieee_754_and_c99, f64);
special_values!(functions_of_an_f32_have_the_special_values_of_ieee_754_and_c99, f32);

#[test]
fn results_overflow_and_underflow_where_they_leave_the_range() {
    // The logarithms of the largest number, of half the smallest, and of twice the largest (sinh, cosh).
    assert!(Elementary::exp(709.782_712_893_383_9_f64).is_finite());
    assert_eq!(Elementary::exp(709.782_712_893_384_1_f64), f64::INFINITY);
    assert_eq!(Elementary::exp(-745.133_219_101_941_1_f64).to_bits(), 1);
    assert_eq!(Elementary::exp(-745.133_219_101_941_3_f64).to_bits(), 0);
    assert!(Elementary::sinh(710.475_860_073_943_8_f64).is_finite());
    assert_eq!(Elementary::cosh(710.475_860_073_944_f64), f64::INFINITY);
    assert!(Elementary::exp(88.722_83_f32).is_finite());
    assert_eq!(Elementary::exp(88.722_85_f32), f32::INFINITY);
    assert_eq!(Elementary::exp(-103.972_07_f32).to_bits(), 1);
    assert_eq!(Elementary::exp(-103.972_09_f32).to_bits(), 0);
    assert!(Elementary::cosh(89.415_98_f32).is_finite());
    assert_eq!(Elementary::sinh(89.416_f32), f32::INFINITY);
    assert_eq!(Elementary::ln(f64::from_bits(1)), -744.440_071_921_381_2);
    assert_eq!(Elementary::ln(f32::from_bits(1)), -103.278_93);
    assert_eq!(Elementary::ln(f64::MAX), 709.782_712_893_384);
}
