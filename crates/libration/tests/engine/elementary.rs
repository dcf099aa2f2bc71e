//! Sine and cosine against a correctly rounded oracle.

use std::f64::consts::FRAC_PI_2;

use libration::elementary::{sine32, sine64};
use libration::{Elementary, Float};

/// Digests of the bits that [`digest`] computes. They are the same on every processor; whoever
/// changes them changes every nonlinear simulation.
const SINE_OF_F64: u64 = 0x0083_5925_22dd_e0b7;
const COSINE_OF_F64: u64 = 0x19aa_6df9_63f9_3e09;
const SINE_OF_F32: u64 = 0x9420_c1f6_397d_2f91;
const COSINE_OF_F32: u64 = 0xec58_68c0_ab27_48e9;

/// A float whose bits the tests may handle.
pub(crate) trait Bits: Float {
    const RANGE: Self;
    /// How many multiples of π/2 the range holds.
    const QUARTERS: u64;
    fn bits(self) -> u64;
    fn of_bits(bits: u64) -> Self;
    fn true_sin(self) -> Self;
    fn true_cos(self) -> Self;
}

macro_rules! bits {
    ($float:ident, $bits:ident, $range:expr, $quarters:expr, $sin:ident, $cos:ident) => {
        impl Bits for $float {
            const RANGE: Self = $range;
            const QUARTERS: u64 = $quarters;
            fn bits(self) -> u64 {
                self.to_bits().into()
            }
            fn of_bits(bits: u64) -> Self {
                $float::from_bits(bits as $bits)
            }
            fn true_sin(self) -> Self {
                core_math::$sin(self)
            }
            fn true_cos(self) -> Self {
                core_math::$cos(self)
            }
        }
    };
}

bits!(f32, u32, sine32::RANGE, 1 << 16, sinf, cosf);
bits!(f64, u64, sine64::RANGE, 1 << 20, sin, cos);

/// SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform among the floats of `[low, high]`, hence about uniform in the exponent.
    pub(crate) fn float<T: Bits>(&mut self, low: T, high: T) -> T {
        T::of_bits(low.bits() + self.bits() % (high.bits() - low.bits() + 1))
    }

    /// Uniform on the interval `[0, high)`.
    pub(crate) fn real<T: Bits>(&mut self, high: T) -> T {
        T::from_f64((self.bits() >> 11) as f64 / 2f64.powi(53) * high.to_f64())
    }
}

/// Non-negative arguments within the range, several million of them.
fn for_each_argument<T: Bits>(mut check: impl FnMut(T)) {
    let mut random = Random(1);
    for _ in 0..1_000_000 {
        check(random.float(T::zero(), T::RANGE));
        check(random.float(T::from_f64(1e-4), T::RANGE));
        check(random.real(T::RANGE));
        check(random.real(T::from_f64(2.0)));
    }
    // Around each multiple of π/2 and of π/4: the first lose the most digits in the reduction,
    // the second are the ends of the polynomials' interval.
    for eighth in 1..2 * T::QUARTERS {
        let centre = T::from_f64(eighth as f64 * (FRAC_PI_2 / 2.0)).bits();
        for bits in centre - 2..=centre + 2 {
            check(T::of_bits(bits));
        }
    }
    for bits in (0..1000).chain(T::RANGE.bits() - 1000..=T::RANGE.bits()) {
        check(T::of_bits(bits));
    }
}

/// How many floats lie from `a` to `b`.
fn floats_between<T: Bits>(a: T, b: T) -> u64 {
    if a == b {
        return 0;
    }
    assert!(a.to_f64() * b.to_f64() > 0.0, "{a:?} and {b:?} differ in sign");
    a.bits().abs_diff(b.bits())
}

/// `computed` is the correctly rounded value or one of its neighbours, and it is the correctly
/// rounded value for all but a share `missed` of the arguments.
fn within_one_ulp<T: Bits>(computed: fn(T) -> T, correct: fn(T) -> T, missed: f64) {
    let mut misses = 0;
    let mut arguments = 0;
    for_each_argument(|x: T| {
        let distance = floats_between(computed(x), correct(x));
        assert!(distance <= 1, "{distance} ulp at {x:?}: {:?}", computed(x));
        misses += distance;
        arguments += 1;
    });
    let share = misses as f64 / f64::from(arguments);
    println!("{misses} of {arguments} are off by an ulp: {share}");
    assert!(share <= missed, "a share of {share} is off by an ulp");
}

#[test]
fn sine_of_f64_is_within_one_ulp_over_its_range() {
    within_one_ulp(f64::sine, f64::true_sin, 0.042);
}

#[test]
fn cosine_of_f64_is_within_one_ulp_over_its_range() {
    within_one_ulp(f64::cosine, f64::true_cos, 0.042);
}

#[test]
fn sine_of_f32_is_within_one_ulp_over_its_range() {
    within_one_ulp(f32::sine, f32::true_sin, 0.029);
}

#[test]
fn cosine_of_f32_is_within_one_ulp_over_its_range() {
    within_one_ulp(f32::cosine, f32::true_cos, 0.029);
}

/// The distance in units of the last place of an `f32` near `exact`.
fn ulps(found: f32, exact: f64) -> f64 {
    let exponent = ((exact.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    (f64::from(found) - exact).abs() / 2f64.powi(exponent.max(-126) - 23)
}

/// One f32 in 997 is tried, or with `LIBRATION_EXHAUSTIVE` set every one, which takes a minute in
/// release and longer here: run it so after a change of the kernels.
#[test]
fn sine_and_cosine_of_f32_are_within_the_documented_error() {
    let stride = if std::env::var_os("LIBRATION_EXHAUSTIVE").is_some() { 1 } else { 997 };
    let (mut sine, mut cosine) = (0.0_f64, 0.0_f64);
    for bits in (0..=sine32::RANGE.to_bits()).step_by(stride) {
        let x = f32::from_bits(bits);
        sine = sine.max(ulps(x.sine(), core_math::sin(x.into())));
        cosine = cosine.max(ulps(x.cosine(), core_math::cos(x.into())));
    }
    assert!(sine < 0.81 && cosine < 0.81, "sine within {sine} ulp, cosine within {cosine} ulp");
}

/// The functions under test by names that the standard library's methods do not hide.
trait Functions: Elementary {
    fn sine(self) -> Self {
        Elementary::sin(self)
    }
    fn cosine(self) -> Self {
        Elementary::cos(self)
    }
}

impl<T: Elementary> Functions for T {}

fn symmetric_and_bounded<T: Bits>() {
    for_each_argument(|x: T| {
        assert_eq!((-x).sine().bits(), (-x.sine()).bits(), "sine is not odd at {x:?}");
        assert_eq!((-x).cosine().bits(), x.cosine().bits(), "cosine is not even at {x:?}");
        assert!(x.sine().to_f64().abs() <= 1.0, "sine exceeds 1 at {x:?}");
        assert!(x.cosine().to_f64().abs() <= 1.0, "cosine exceeds 1 at {x:?}");
    });
}

#[test]
fn f64_sine_is_odd_cosine_is_even_and_neither_exceeds_one() {
    symmetric_and_bounded::<f64>();
}

#[test]
fn f32_sine_is_odd_cosine_is_even_and_neither_exceeds_one() {
    symmetric_and_bounded::<f32>();
}

fn tiny_arguments<T: Bits>() {
    let one = T::one().bits();
    assert_eq!((-T::zero()).sine().bits(), (-T::zero()).bits(), "sin(-0) is -0");
    assert_eq!(T::zero().sine().bits(), 0);
    assert_eq!(T::zero().cosine().bits(), one);
    // sin x = x·(1 − x²/6) rounds to x, and cos x to 1, well before x² reaches the roundoff.
    let tiny = T::from_f64(0.5 * T::UNIT_ROUNDOFF.sqrt());
    let mut random = Random(2);
    for _ in 0..100_000 {
        let x = random.float(T::zero(), tiny);
        assert_eq!(x.sine().bits(), x.bits(), "sine of {x:?}");
        assert_eq!(x.cosine().bits(), one, "cosine of {x:?}");
    }
}

#[test]
fn tiny_and_subnormal_arguments_are_their_own_sines() {
    tiny_arguments::<f64>();
    tiny_arguments::<f32>();
}

fn nan_beyond_range<T: Bits>(largest: T, infinity: T, nan: T) {
    assert!(T::RANGE.sine().is_finite() && T::RANGE.cosine().is_finite());
    let beyond = T::of_bits(T::RANGE.bits() + 1);
    let mut random = Random(3);
    let some = (0..100_000).map(|_| random.float(beyond, infinity));
    for x in some.chain([beyond, largest, infinity, nan]) {
        for x in [x, -x] {
            assert_eq!(x.sine().bits(), nan.bits(), "sine of {x:?}");
            assert_eq!(x.cosine().bits(), nan.bits(), "cosine of {x:?}");
        }
    }
}

#[test]
fn beyond_the_range_and_for_infinities_and_nan_the_result_is_one_and_the_same_nan() {
    nan_beyond_range(f64::MAX, f64::INFINITY, f64::NAN);
    nan_beyond_range(f32::MAX, f32::INFINITY, f32::NAN);
}

/// FNV-1a over the results at a million arguments on both sides of zero.
fn digest<T: Bits>(function: fn(T) -> T) -> u64 {
    let mut random = Random(4);
    let mut digest = 0xcbf2_9ce4_8422_2325;
    for _ in 0..250_000 {
        let any = random.float(T::zero(), T::RANGE);
        let uniform = random.real(T::RANGE);
        for x in [any, -any, uniform, -uniform] {
            digest = (digest ^ function(x).bits()).wrapping_mul(0x0100_0000_01b3);
        }
    }
    digest
}

#[test]
fn the_bits_are_the_same_on_every_machine() {
    let found = [digest(f64::sine), digest(f64::cosine), digest(f32::sine), digest(f32::cosine)];
    let expected = [SINE_OF_F64, COSINE_OF_F64, SINE_OF_F32, COSINE_OF_F32];
    assert_eq!(found, expected, "{found:#018x?}");
}

#[test]
fn square_root_and_reciprocal_are_the_correctly_rounded_operations() {
    let mut random = Random(5);
    for _ in 0..100_000 {
        let x: f32 = random.float(1e-30, 1e30);
        assert_eq!(Elementary::sqrt(x), f64::from(x).sqrt() as f32);
        assert_eq!(Elementary::recip(x), (1.0 / f64::from(x)) as f32);
        let x: f64 = random.float(1e-100, 1e100);
        assert_eq!(Elementary::sqrt(x), x.sqrt());
        assert_eq!(Elementary::recip(x), 1.0 / x);
    }
}
