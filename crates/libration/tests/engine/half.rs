//! The 16-bit floats against correct rounding done independently, by scaling to an integer.

use half::{bf16, f16};
use libration::Float;
use libration::elementary::sine64;

/// A 16-bit float format.
trait Format: Float + std::ops::Div<Output = Self> {
    /// Bits of the significand, the hidden one included.
    const PRECISION: i32;
    /// Exponent of the smallest normal number.
    const MIN_EXPONENT: i32;
    const MAX: f64;
    fn of_bits(bits: u16) -> Self;
    fn bits(self) -> u16;
    fn of_f32(x: f32) -> Self;
}

macro_rules! half_format {
    ($float:ident, $precision:literal, $min_exponent:literal, $max:expr) => {
        impl Format for $float {
            const PRECISION: i32 = $precision;
            const MIN_EXPONENT: i32 = $min_exponent;
            const MAX: f64 = $max;
            fn of_bits(bits: u16) -> Self {
                $float::from_bits(bits)
            }
            fn bits(self) -> u16 {
                self.to_bits()
            }
            fn of_f32(x: f32) -> Self {
                $float::from_f32(x)
            }
        }
    };
}

half_format!(f16, 11, -14, 65504.0);
half_format!(bf16, 8, -126, 3.3895313892515355e38);

/// `x` rounded to the format: nearest, ties to even, subnormals and overflow included.
fn rounded<T: Format>(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    let quantum = 2f64.powi(exponent.max(T::MIN_EXPONENT) + 1 - T::PRECISION);
    let result = (x / quantum).round_ties_even() * quantum;
    if result.abs() > T::MAX { f64::INFINITY.copysign(x) } else { result }
}

/// The neighbour of `x` with an odd significand if `lost`, the rest of the exact value, is not 0.
///
/// With its 53 bits it then rounds to a 16-bit format as the exact value would.
fn sticky(x: f64, lost: f64) -> f64 {
    if lost == 0.0 || !x.is_finite() || x.to_bits() & 1 == 1 {
        return x;
    }
    let outwards = (lost > 0.0) == (x > 0.0);
    f64::from_bits(if outwards { x.to_bits() + 1 } else { x.to_bits() - 1 })
}

fn sum(a: f64, b: f64) -> f64 {
    let sum = a + b;
    let b_part = sum - a;
    sticky(sum, (a - (sum - b_part)) + (b - b_part))
}

fn quotient(a: f64, b: f64) -> f64 {
    let quotient = a / b;
    let rest = (-quotient).mul_add(b, a);
    sticky(quotient, if b > 0.0 { rest } else { -rest })
}

fn square_root(a: f64) -> f64 {
    let root = a.sqrt();
    sticky(root, (-root).mul_add(root, a))
}

fn all<T: Format>() -> impl Iterator<Item = T> {
    (0..=u16::MAX).map(T::of_bits)
}

/// Floats of every exponent and both signs, zeros, the smallest, the largest, infinities and NaN.
fn some<T: Format>() -> impl Iterator<Item = T> {
    (0..=u16::MAX).step_by(SAMPLE).chain([0x8000, 0x8001, 1, 2]).map(T::of_bits).chain([
        T::from_f64(1.0),
        T::from_f64(T::MAX),
        T::from_f64(-T::MAX),
        T::from_f64(f64::INFINITY),
        T::from_f64(f64::NAN),
    ])
}

/// One operand in so many is tried with every other operand. A divisor of 33 has passed too.
const SAMPLE: usize = 331;

#[track_caller]
fn assert_is<T: Format>(found: T, exact: f64, what: impl Fn() -> String) {
    let expected = rounded::<T>(exact);
    let found = found.to_f64();
    let same = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
    assert!(same, "{} gave {found:e}, correctly rounded {expected:e}", what());
}

fn operations_round_correctly<T: Format>() {
    for a in some::<T>() {
        for b in all::<T>() {
            let (x, y) = (a.to_f64(), b.to_f64());
            assert_is(a + b, sum(x, y), || format!("{a:?} + {b:?}"));
            assert_is(a - b, sum(x, -y), || format!("{a:?} - {b:?}"));
            assert_is(a * b, x * y, || format!("{a:?} * {b:?}"));
            assert_is(a / b, quotient(x, y), || format!("{a:?} / {b:?}"));
        }
    }
    for a in all::<T>() {
        assert_is(-a, -a.to_f64(), || format!("-{a:?}"));
        assert_is(a.sqrt(), square_root(a.to_f64()), || format!("sqrt {a:?}"));
        assert_is(a.recip(), quotient(1.0, a.to_f64()), || format!("1 / {a:?}"));
    }
}

#[test]
fn every_f16_operation_is_rounded_correctly() {
    operations_round_correctly::<f16>();
}

#[test]
fn every_bf16_operation_is_rounded_correctly() {
    operations_round_correctly::<bf16>();
}

fn ratio_rounds_twice<T: Format>() {
    for a in all::<T>() {
        for (num, den) in [(1, 2), (1, 3), (1, 6), (-7, 24), (55, 24), (2, -3), (128, 125)] {
            let product = rounded::<T>(a.to_f64() * f64::from(num));
            let what = || format!("{a:?} * {num} / {den}");
            assert_is(a.ratio(num, den), quotient(product, f64::from(den)), what);
        }
    }
}

#[test]
fn a_ratio_is_a_rounded_product_and_a_rounded_quotient() {
    ratio_rounds_twice::<f16>();
    ratio_rounds_twice::<bf16>();
}

fn conversion_rounds_once<T: Format>() {
    for a in all::<T>() {
        let x = a.to_f64();
        let up = T::of_bits(a.bits().wrapping_add(1)).to_f64();
        let middle = 0.5 * (x + up);
        // Next to a tie, f32 rounds to the tie and forgets the side.
        let nearly = [1e-14, -1e-14, 1e-9, -1e-9, 1e-5, -1e-5].map(|d| middle * (1.0 + d));
        for c in [x, middle, 0.25 * x + 0.75 * up].into_iter().chain(nearly) {
            assert_is(T::from_f64(c), c, || format!("from_f64({c:e})"));
            let c = c as f32;
            assert_is(T::of_f32(c), c.into(), || format!("from_f32({c:e})"));
        }
    }
    for c in [1e300, 1e-300, 1e-40, 1e-42, f64::MAX, f64::MIN_POSITIVE, 5e-324, f64::INFINITY] {
        for c in [c, -c] {
            assert_is(T::from_f64(c), c, || format!("from_f64({c:e})"));
        }
    }
    assert!(T::from_f64(f64::NAN).to_f64().is_nan());
}

#[test]
fn conversion_from_f64_rounds_once_on_every_processor() {
    conversion_rounds_once::<f16>();
    conversion_rounds_once::<bf16>();
}

/// The value of a bit pattern by the definition of the format; infinities and NaN excepted.
fn value<T: Format>(bits: u16) -> f64 {
    let fraction_bits = T::PRECISION - 1;
    let magnitude = i32::from(bits & 0x7fff);
    let (exponent, fraction) = (magnitude >> fraction_bits, magnitude & ((1 << fraction_bits) - 1));
    let hidden = if exponent == 0 { 0 } else { 1 << fraction_bits };
    let quantum = 2f64.powi(T::MIN_EXPONENT + exponent.max(1) - 1 - fraction_bits);
    f64::from(hidden + fraction) * quantum * if bits >> 15 == 0 { 1.0 } else { -1.0 }
}

fn values_follow_the_definition<T: Format>() {
    let infinity = T::from_f64(f64::INFINITY).bits();
    for a in all::<T>() {
        match (a.bits() & 0x7fff).cmp(&infinity) {
            std::cmp::Ordering::Less => {
                assert!(a.is_finite());
                assert_eq!(a.to_f64().to_bits(), value::<T>(a.bits()).to_bits(), "{a:?}");
            }
            std::cmp::Ordering::Equal => assert!(a.to_f64().is_infinite() && !a.is_finite()),
            std::cmp::Ordering::Greater => assert!(a.to_f64().is_nan() && !a.is_finite()),
        }
    }
}

#[test]
fn the_value_of_every_bit_pattern_is_the_defined_one() {
    values_follow_the_definition::<f16>();
    values_follow_the_definition::<bf16>();
}

#[test]
fn names_and_unit_roundoffs() {
    fn describe<T: Float>() -> (&'static str, f64) {
        let u = T::UNIT_ROUNDOFF;
        // 1 + u is a tie and goes to the even 1; more than u goes up.
        assert!(T::from_f64(1.0 + 1.5 * u).to_f64() > 1.0);
        assert_eq!(T::one() + T::from_f64(u), T::one());
        assert_eq!((T::one() + T::from_f64(2.0 * u)).to_f64(), 1.0 + 2.0 * u);
        (T::NAME, u)
    }
    assert_eq!(describe::<f64>(), ("f64", 2f64.powi(-53)));
    assert_eq!(describe::<f32>(), ("f32", 2f64.powi(-24)));
    assert_eq!(describe::<f16>(), ("f16", 2f64.powi(-11)));
    assert_eq!(describe::<bf16>(), ("bf16", 2f64.powi(-8)));
}

fn sines_round_correctly<T: Format>() {
    for a in all::<T>() {
        let x = a.to_f64();
        let within = x.abs() <= sine64::RANGE;
        let (sine, cosine) =
            if within { (core_math::sin(x), core_math::cos(x)) } else { (f64::NAN, f64::NAN) };
        assert_is(a.sin(), sine, || format!("sin {a:?}"));
        assert_is(a.cos(), cosine, || format!("cos {a:?}"));
    }
}

#[test]
fn every_sine_and_cosine_of_f16_and_bf16_is_rounded_correctly() {
    sines_round_correctly::<f16>();
    sines_round_correctly::<bf16>();
}

/// Against the functions of CORE-MATH, which are right to 53 bits.
fn functions_round_correctly<T: Format>() {
    macro_rules! check {
        ($a:ident: $($name:ident $correct:ident)*) => {$(
            let exact = core_math::$correct($a.to_f64());
            assert_is($a.$name(), exact, || format!("{} {:?}", stringify!($name), $a));
        )*};
    }
    for a in all::<T>() {
        check!(a: asin asin acos acos atan atan exp exp ln log sinh sinh cosh cosh tanh tanh);
        let x = a.to_f64();
        let tangent = if x.abs() <= sine64::RANGE { core_math::tan(x) } else { f64::NAN };
        assert_is(a.tan(), tangent, || format!("tan {a:?}"));
        assert_is(a.abs(), x.abs(), || format!("abs {a:?}"));
        for b in some::<T>().step_by(41) {
            let y = b.to_f64();
            assert_is(a.atan2(b), core_math::atan2(x, y), || format!("atan2 {a:?} {b:?}"));
            let [least, greatest] = if x.is_nan() || y.is_nan() {
                [f64::NAN; 2]
            } else if (x, x.is_sign_positive()) < (y, y.is_sign_positive()) {
                [x, y]
            } else {
                [y, x]
            };
            assert_is(a.min(b), least, || format!("min {a:?} {b:?}"));
            assert_is(a.max(b), greatest, || format!("max {a:?} {b:?}"));
            let choice = a.select_less_equal(b, T::one(), T::zero());
            assert_is(choice, f64::from(u8::from(x <= y)), || format!("{a:?} <= {b:?}"));
        }
    }
}

#[test]
fn every_function_of_f16_and_bf16_is_rounded_correctly() {
    functions_round_correctly::<f16>();
    functions_round_correctly::<bf16>();
}
