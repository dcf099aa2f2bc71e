//! Special values of functions of two arguments after IEEE 754 and C99, annex F.9, and choices by their order.

use libration::Elementary;

macro_rules! special_pairs {
    ($name:ident, $float:ident) => {
        #[test]
        fn $name() {
            use std::$float::consts::{FRAC_PI_2, FRAC_PI_4, PI};
            const INF: $float = $float::INFINITY;
            const NAN: $float = $float::NAN;
            const MAX: $float = $float::MAX;
            // The smallest subnormal number.
            const TINY: $float = $float::from_bits(1);
            let quarters = FRAC_PI_4 + FRAC_PI_2;
            type Pairs<'a> =
                (&'a str, fn($float, $float) -> $float, &'a [($float, $float, $float)]);
            let functions: [Pairs; 3] = [
                (
                    "atan2",
                    Elementary::atan2,
                    &[
                        (0.0, 0.0, 0.0),
                        (-0.0, 0.0, -0.0),
                        (0.0, -0.0, PI),
                        (-0.0, -0.0, -PI),
                        (0.0, 1.0, 0.0),
                        (-0.0, 1.0, -0.0),
                        (0.0, -1.0, PI),
                        (-0.0, -1.0, -PI),
                        (1.0, 0.0, FRAC_PI_2),
                        (1.0, -0.0, FRAC_PI_2),
                        (-1.0, 0.0, -FRAC_PI_2),
                        (-1.0, -0.0, -FRAC_PI_2),
                        (1.0, 1.0, FRAC_PI_4),
                        (-1.0, 1.0, -FRAC_PI_4),
                        (1.0, -1.0, quarters),
                        (-1.0, -1.0, -quarters),
                        (INF, INF, FRAC_PI_4),
                        (-INF, INF, -FRAC_PI_4),
                        (INF, -INF, quarters),
                        (-INF, -INF, -quarters),
                        (1.0, INF, 0.0),
                        (-1.0, INF, -0.0),
                        (1.0, -INF, PI),
                        (-1.0, -INF, -PI),
                        (INF, 1.0, FRAC_PI_2),
                        (-INF, -1.0, -FRAC_PI_2),
                        (MAX, MAX, FRAC_PI_4),
                        (TINY, TINY, FRAC_PI_4),
                        (-TINY, -TINY, -quarters),
                        (TINY, MAX, 0.0),
                        (TINY, -MAX, PI),
                        (MAX, TINY, FRAC_PI_2),
                        (TINY, 1.0, TINY),
                        (-TINY, 0.5, -2.0 * TINY),
                        (NAN, 1.0, NAN),
                        (1.0, -NAN, NAN),
                        (NAN, INF, NAN),
                    ],
                ),
                (
                    "min",
                    Elementary::min,
                    &[
                        (1.0, 2.0, 1.0),
                        (2.0, 1.0, 1.0),
                        (-0.0, 0.0, -0.0),
                        (0.0, -0.0, -0.0),
                        (0.0, 0.0, 0.0),
                        (-INF, INF, -INF),
                        (-3.0, -3.0, -3.0),
                        (NAN, 1.0, NAN),
                        (1.0, NAN, NAN),
                        (-NAN, INF, NAN),
                    ],
                ),
                (
                    "max",
                    Elementary::max,
                    &[
                        (1.0, 2.0, 2.0),
                        (2.0, 1.0, 2.0),
                        (-0.0, 0.0, 0.0),
                        (0.0, -0.0, 0.0),
                        (-0.0, -0.0, -0.0),
                        (-INF, INF, INF),
                        (-3.0, -3.0, -3.0),
                        (NAN, 1.0, NAN),
                        (1.0, NAN, NAN),
                        (-NAN, INF, NAN),
                    ],
                ),
            ];
            for (name, function, values) in functions {
                for &(y, x, value) in values {
                    let found = function(std::hint::black_box(y), std::hint::black_box(x));
                    assert_eq!(
                        found.to_bits(),
                        value.to_bits(),
                        "{name} of {y:e}, {x:e} is {found:e}"
                    );
                }
            }

            let choices = |a: $float, b: $float| {
                [
                    a.select_less(b, 1.0, 2.0),
                    a.select_equal(b, 1.0, 2.0),
                    a.select_less_equal(b, 1.0, 2.0),
                ]
            };
            assert_eq!(choices(1.0, 2.0), [1.0, 2.0, 1.0]);
            assert_eq!(choices(2.0, 1.0), [2.0, 2.0, 2.0]);
            assert_eq!(choices(-0.0, 0.0), [2.0, 1.0, 1.0]);
            assert_eq!(choices(NAN, 1.0), [2.0; 3]);
            assert_eq!(choices(1.0, NAN), [2.0; 3]);
            assert_eq!(choices(NAN, NAN), [2.0; 3]);
        }
    };
}

special_pairs!(functions_of_two_f64_have_the_special_values_of_ieee_754_and_c99, f64);
special_pairs!(functions_of_two_f32_have_the_special_values_of_ieee_754_and_c99, f32);
