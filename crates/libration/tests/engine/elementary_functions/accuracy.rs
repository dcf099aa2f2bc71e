//! Errors in units of the last place, against mpmath, CORE-MATH and double-double arithmetic.

use libration::elementary::sine32;
use libration::number::{TwoFloat, Wide};
use libration::{Elementary, Scalar};

use super::catalogue::{ATAN2_ERRORS, FUNCTIONS, function};
use super::values::{ulps_of_f32, ulps_of_f64, values};
use crate::elementary::Random;

#[test]
fn values_of_mpmath_are_found_within_the_documented_errors() {
    for value in values() {
        let (x, high, low) = (value.x, value.high, value.low);
        let (double, single, errors): (f64, f32, _) = match (value.other, function(value.function))
        {
            (Some(other), _) => (x.angle(other), (x as f32).angle(other as f32), ATAN2_ERRORS),
            (None, Some(f)) => ((f.double)(x), (f.single)(x as f32), f.errors),
            // Sine and cosine.
            (None, None) => continue,
        };
        let error = ulps_of_f64(double, high, low);
        assert!(error <= errors[0], "{} of {x:e}: {error} ulp", value.function);
        let exact = [x, value.other.unwrap_or(0.0)].map(|x| f64::from(x as f32) == x);
        if exact == [true; 2] {
            let error = ulps_of_f32(single, high);
            assert!(error <= errors[1], "{} of {x:e} as f32: {error} ulp", value.function);
        }
    }
}

/// `atan2` by a name that the standard library's method does not hide.
trait Angle: Elementary {
    fn angle(self, x: Self) -> Self {
        Elementary::atan2(self, x)
    }
}

impl Angle for f32 {}
impl Angle for f64 {}

#[test]
fn values_of_mpmath_are_found_to_30_digits_by_double_doubles_and_1024_bits() {
    macro_rules! call {
        ($type:ident, $value:expr, $($name:ident)*) => {{
            let x = $type::from_f64($value.x);
            match ($value.function, $value.other) {
                $((stringify!($name), _) => x.$name(),)*
                ("atan2", Some(other)) => x.atan2($type::from_f64(other)),
                (name, _) => panic!("{name}"),
            }
        }};
    }
    for value in values() {
        let found = call!(TwoFloat, value, sin cos tan asin acos atan exp ln sinh cosh tanh);
        let wide = call!(Wide, value, sin cos tan asin acos atan exp ln sinh cosh tanh);
        let exact = Wide::from_f64(value.high) + Wide::from_f64(value.low);
        // Below 2⁻⁹⁰⁰ the low parts are subnormal, and the table's own values have fewer digits.
        if value.high.abs() < 1e-270 || value.x.abs() < 1e-270 {
            continue;
        }
        let what = format!("{} of {:e}", value.function, value.x);
        let error = ((Wide::from(found) - exact) / exact).abs().to_f64();
        assert!(error <= 1e-30, "{what}: {error:e}");
        // The table's values are rounded to 107 bits.
        let error = ((wide - exact) / exact).abs().to_f64();
        assert!(error <= 2f64.powi(-107), "{what} in 1024 bits: {error:e}");
    }
}

/// Of both signs, uniform in the exponent up to `largest`, and uniform up to it and up to 4.
fn arguments(largest: f64, count: usize) -> impl Iterator<Item = f64> {
    let mut random = Random(6);
    (0..count).map(move |i| {
        let x = match i % 4 {
            0 => random.float(0.0, largest),
            1 => random.real(largest),
            2 => random.float(1e-3, largest.min(20.0)),
            _ => random.real(largest.min(4.0)),
        };
        if random.bits() & 1 == 0 { -x } else { x }
    })
}

#[test]
fn functions_of_f64_are_within_the_documented_errors_of_double_doubles() {
    for function in FUNCTIONS {
        let mut largest = 0.0_f64;
        // Beyond these the low part of the value or of its powers is lost.
        let normal = |x: &f64| x.abs() > 1e-280 && (x.abs() < 600.0 || function.largest > 1e3);
        for x in arguments(function.largest.min(1e280), 20_000).filter(normal) {
            let exact = (function.wider)(TwoFloat::from_f64(x));
            if !exact.hi().is_nan() {
                largest = largest.max(ulps_of_f64((function.double)(x), exact.hi(), exact.lo()));
            }
        }
        println!("{} errs by {largest} ulp", function.name);
        assert!(largest <= function.errors[0], "{}: {largest} ulp", function.name);
        // The arguments reach the errors that are documented.
        assert!(largest >= 0.5, "{}: {largest} ulp", function.name);
    }
}

#[test]
fn functions_of_f64_give_the_correctly_rounded_value_or_its_neighbour_over_the_whole_range() {
    for function in FUNCTIONS {
        for x in arguments(function.largest, 100_000) {
            let (found, correct) = ((function.double)(x), (function.correct)(x));
            let distance = found.to_bits().abs_diff(correct.to_bits());
            let same = distance <= 1 || found.is_nan() && correct.is_nan();
            assert!(same, "{} of {x:e} is {found:e}, correctly rounded {correct:e}", function.name);
        }
    }
}

/// One `f32` in 99,991 is tried, or with `LIBRATION_EXHAUSTIVE` set every one, which takes an hour in release.
#[test]
fn functions_of_f32_are_within_the_documented_errors_over_the_whole_range() {
    let stride = if std::env::var_os("LIBRATION_EXHAUSTIVE").is_some() { 1 } else { 99_991 };
    for function in FUNCTIONS {
        let (mut normal, mut subnormal) = (0.0_f64, 0.0_f64);
        for bits in (0..=f32::INFINITY.to_bits()).step_by(stride) {
            for x in [f32::from_bits(bits), -f32::from_bits(bits)] {
                let found = (function.single)(x);
                let exact = (function.correct)(x.into());
                let beyond = function.name == "tan" && x.abs() > sine32::RANGE;
                assert_eq!(found.is_nan(), exact.is_nan() || beyond, "{} of {x:e}", function.name);
                let error = ulps_of_f32(found, exact);
                if exact.abs() < f64::from(f32::MIN_POSITIVE) {
                    subnormal = subnormal.max(error);
                } else {
                    normal = normal.max(error);
                }
            }
        }
        println!("{} errs by {normal} ulp, {subnormal} among the subnormals", function.name);
        assert!(normal <= function.errors[1], "{}: {normal} ulp", function.name);
        // A subnormal result is rounded a second time.
        assert!(subnormal <= 0.76, "{}: {subnormal} ulp", function.name);
    }
}

#[test]
fn atan2_is_within_the_documented_errors_in_all_quadrants() {
    let mut random = Random(7);
    let mut sign = {
        let mut random = Random(8);
        move |x: f64| if random.bits() & 1 == 0 { -x } else { x }
    };
    let [mut double, mut single] = [0.0_f64; 2];
    for i in 0..40_000 {
        let y = random.float(1e-30, 1e30);
        let x = match i % 3 {
            0 => random.float(1e-30, 1e30),
            1 => y * random.real(5.0),
            _ => y * (1.0 + random.real(1e-3)),
        };
        let (y, x) = (sign(y), sign(x));
        let exact = TwoFloat::from_f64(y).atan2(TwoFloat::from_f64(x));
        double = double.max(ulps_of_f64(y.angle(x), exact.hi(), exact.lo()));
        let (y, x) = (y as f32, x as f32);
        single = single.max(ulps_of_f32(y.angle(x), core_math::atan2(y.into(), x.into())));
    }
    println!("atan2 errs by {double} and {single} ulp");
    assert!(double <= ATAN2_ERRORS[0] && double > 0.5, "{double} ulp");
    assert!(single <= ATAN2_ERRORS[1], "{single} ulp");
}

#[test]
fn atan2_of_any_two_f64_is_the_correctly_rounded_value_or_its_neighbour() {
    let mut random = Random(9);
    for _ in 0..100_000 {
        let (y, x) = (f64::from_bits(random.bits()), f64::from_bits(random.bits()));
        let (found, correct) = (y.angle(x), core_math::atan2(y, x));
        let distance = found.to_bits().abs_diff(correct.to_bits());
        let same = distance <= 1 || found.is_nan() && correct.is_nan();
        assert!(same, "the angle of ({x:e}, {y:e}) is {found:e}, correctly rounded {correct:e}");
    }
}

#[test]
fn subnormal_exponentials_of_f64_are_within_the_documented_error() {
    let mut random = Random(12);
    let mut largest = 0.0_f64;
    for _ in 0..1000 {
        let x = -708.4 - random.real(3.0);
        let exact = Wide::from_f64(x).exp();
        let error = (Wide::from_f64(Elementary::exp(x)) - exact).abs().scaled(1074).to_f64();
        largest = largest.max(error);
    }
    // The second rounding errs by half a unit, the first by a quarter next to the normal numbers.
    assert!((0.5..0.76).contains(&largest), "{largest} ulp");
}
