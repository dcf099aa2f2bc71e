use core::cmp::Ordering;

use libration::Scalar;
use libration::number::{Ratio, Wide};
use proptest::prelude::*;

use crate::exp2;

fn fraction() -> impl Strategy<Value = Ratio> {
    prop_oneof![
        (any::<i64>(), any::<i64>().prop_filter("zero", |&d| d != 0))
            .prop_map(|(n, d)| Ratio::new(n, d)),
        (-30..30_i64, 1..30_i64).prop_map(|(n, d)| Ratio::new(n, d)),
        (-1e30..1e30_f64).prop_map(Ratio::from_f64),
    ]
}

fn finite() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite())
}

proptest! {
    #[test]
    fn fractions_are_a_field(a in fraction(), b in fraction(), c in fraction()) {
        prop_assert_eq!(a + b, b + a);
        prop_assert_eq!((a + b) + c, a + (b + c));
        prop_assert_eq!(a * b, b * a);
        prop_assert_eq!((a * b) * c, a * (b * c));
        prop_assert_eq!(a * (b + c), a * b + a * c);
        prop_assert_eq!(a - a, Ratio::ZERO);
        prop_assert_eq!(a + b - b, a);
        prop_assert_eq!(a * Ratio::ONE + Ratio::ZERO, a);
        if !b.is_zero() {
            prop_assert_eq!(b * b.recip(), Ratio::ONE);
            prop_assert_eq!(a.checked_div(b).map(|q| q * b), Some(a));
        }
        prop_assert!(((a + b) * c).is_valid());
    }

    #[test]
    fn order_is_that_of_the_difference(a in fraction(), b in fraction()) {
        let by_sign = match (a - b).sign() { 1 => Ordering::Greater, 0 => Ordering::Equal, _ => Ordering::Less };
        prop_assert_eq!(a.cmp(&b), by_sign);
        prop_assert_eq!(b.cmp(&a), by_sign.reverse());
    }

    #[test]
    fn small_fractions_agree_with_cross_multiplication(
        a in -999..999_i128, b in 1..999_i128, c in -999..999_i128, d in 1..999_i128,
    ) {
        let r = |n: i128, d: i128| Ratio::new(n as i64, d as i64);
        prop_assert_eq!(r(a, b) + r(c, d), r(a * d + c * b, b * d));
        prop_assert_eq!(r(a, b) * r(c, d), r(a * c, b * d));
        prop_assert_eq!(r(a, b).cmp(&r(c, d)), (a * d).cmp(&(c * b)));
    }

    #[test]
    fn every_finite_float_is_exact(x in finite()) {
        prop_assert_eq!(Ratio::from_f64(x).to_f64(), x);
        prop_assert_eq!(Wide::from(Ratio::from_f64(x)), Wide::from_f64(x));
    }

    #[test]
    fn to_f64_is_correctly_rounded(n in any::<i64>(), d in 1..i64::MAX) {
        // The nearest float is no further away than either neighbour.
        let exact = Ratio::new(n, d);
        let x = exact.to_f64();
        let distance = |x: f64| (Ratio::from_f64(x) - exact).abs();
        prop_assert!(distance(x) <= distance(x.next_up()).min(distance(x.next_down())));
    }

    #[test]
    fn to_f64_agrees_with_the_rounding_of_the_language(n in any::<i64>(), m in any::<i32>()) {
        prop_assert_eq!(Ratio::from(n).to_f64(), n as f64);
        // Both operands are exact, so the division of floats rounds only once.
        prop_assume!(m != 0);
        prop_assert_eq!(Ratio::new(m.into(), 7).to_f64(), f64::from(m) / 7.0);
        prop_assert_eq!(Ratio::new(1, m.into()).to_f64(), 1.0 / f64::from(m));
    }
}

#[test]
fn ties_go_to_even() {
    let half_ulp = Ratio::from_f64(exp2(-53));
    assert_eq!((Ratio::ONE + half_ulp).to_f64(), 1.0);
    let odd = Ratio::from_f64(1.0 + f64::EPSILON);
    assert_eq!((odd + half_ulp).to_f64(), 1.0 + 2.0 * f64::EPSILON);
    let crumb = Ratio::from_f64(exp2(-1000));
    assert_eq!((Ratio::ONE + half_ulp + crumb).to_f64(), 1.0 + f64::EPSILON);
    assert_eq!((odd + half_ulp - crumb).to_f64(), 1.0 + f64::EPSILON);
    // A third of a crumb is not dyadic: only the remainder tells.
    assert_eq!((Ratio::ONE + half_ulp + crumb.ratio(1, 3)).to_f64(), 1.0 + f64::EPSILON);
}

#[test]
fn rounding_reaches_both_ends_of_the_range() {
    let tiny = Ratio::from_f64(f64::from_bits(1));
    assert_eq!(tiny.ratio(1, 2).to_f64(), 0.0);
    assert_eq!(tiny.ratio(3, 2).to_f64(), f64::from_bits(2));
    assert_eq!(tiny.ratio(2, 3).to_f64(), f64::from_bits(1));
    assert_eq!(tiny.ratio(1, 3).to_f64(), 0.0);
    assert_eq!((-tiny).ratio(5, 2).to_f64(), -f64::from_bits(2));
    let below_normal = Ratio::from_f64(f64::MIN_POSITIVE) - tiny.ratio(1, 2);
    assert_eq!(below_normal.to_f64(), f64::MIN_POSITIVE);
    let max = Ratio::from_f64(f64::MAX);
    let half_ulp = Ratio::from_f64(exp2(970));
    assert_eq!((max + half_ulp.ratio(999, 1000)).to_f64(), f64::MAX);
    assert_eq!((max + half_ulp).to_f64(), f64::INFINITY);
    assert_eq!((-max - half_ulp).to_f64(), f64::NEG_INFINITY);
}

#[test]
fn dyadic_sums_do_not_double_their_size() {
    // A thousand terms with denominators up to 2⁵²: the product of these would have 52000 bits.
    let sum = (0..1000)
        .fold(Ratio::ZERO, |sum, k| sum + Ratio::from_f64(1.0 + f64::from(k) * f64::EPSILON));
    assert_eq!(sum, Ratio::from(1000) + Ratio::from_f64(499_500.0 * f64::EPSILON));
    // And over odd denominators, of which only the least common multiple is needed.
    let harmonic = (1..=200).fold(Ratio::ZERO, |sum, k| sum + Ratio::new(1, k));
    assert!((harmonic.to_f64() - 5.878_030_948_121_444).abs() < 1e-14);
}

#[test]
fn overflow_is_detected_and_contagious() {
    let big = (0..11).fold(Ratio::from(3), |x, _| x * x);
    assert!(!big.is_valid(), "3^2048 has 3246 bits");
    assert_eq!(big, Ratio::UNDEFINED);
    let deep = (0..10).fold(Ratio::new(1, 3), |x, _| x * x);
    assert!(!deep.is_valid(), "3^-1024 has a denominator of 1624 bits");
    let long = (0..10).fold(Ratio::from(3), |x, _| x * x);
    assert!(long.is_valid() && !long.recip().is_valid(), "3^1024 has 1624 bits");
    assert_eq!(Ratio::ONE.checked_div(long), None);
    let far = Ratio::from_f64(f64::MAX);
    let far = far * far;
    assert!(far.is_valid(), "a power of two costs nothing");
    assert!(!(far + far.recip().ratio(1, 2)).is_valid(), "these two are 4095 bits apart");
    let doubled = (0..40).fold(Ratio::from(2), |x, _| x * x);
    assert!(!doubled.is_valid(), "the exponent is bounded, too");
    let large = (0..30).fold(Ratio::from(2), |x, _| x * x);
    assert!(large.is_valid() && large.recip().is_valid(), "2^(2^30) is the largest power of two");
    assert!(!(large * Ratio::from(2)).is_valid() && !(large.recip().ratio(1, 2)).is_valid());
    for x in
        [Ratio::new(1, 0), Ratio::ZERO.recip(), Ratio::from_f64(f64::NAN), Ratio::ONE.ratio(1, 0)]
    {
        assert!(!x.is_valid() && x.checked().is_none() && x.to_f64().is_nan());
        for y in [x + Ratio::ONE, Ratio::ZERO - x, x * Ratio::ZERO, Ratio::ZERO * x, -x, x.recip()]
        {
            assert_eq!(y, Ratio::UNDEFINED);
        }
        assert!(x < Ratio::from(i64::MIN) && x.cmp(&x).is_eq() && x.sign() == 0);
    }
    assert_eq!(Ratio::ONE.checked_div(Ratio::ZERO), None);
}

#[test]
fn sums_that_do_not_fit_are_detected() {
    let power = (0..10).fold(Ratio::from(2), |x, _| x * x);
    let ones = (power - Ratio::ONE) * (power + Ratio::ONE);
    assert!(ones.is_valid(), "2^2048 − 1 has 2048 bits");
    assert!(!(ones + Ratio::from(2)).is_valid(), "2^2048 + 1 has one more");
    let inverse_power = |base, n| (0..n).fold(Ratio::ONE, |x, _| x * Ratio::new(1, base));
    let (third, fifth) = (inverse_power(3, 600), inverse_power(5, 400));
    assert!(third.is_valid() && fifth.is_valid());
    assert!(!(third + fifth).is_valid(), "3^600·5^400 has 1880 bits");
}

#[test]
fn extremes_of_i64_are_fractions() {
    let min = Ratio::from(i64::MIN);
    assert_eq!(min.to_string(), i64::MIN.to_string());
    assert_eq!(Ratio::new(i64::MIN, i64::MIN), Ratio::ONE);
    assert_eq!(Ratio::new(i64::MAX, i64::MIN).sign(), -1);
}

#[test]
fn display_is_in_lowest_terms() {
    let show = |n, d| Ratio::new(n, d).to_string();
    assert_eq!(show(2, 48), "1/24");
    assert_eq!(show(-2, 48), "-1/24");
    assert_eq!(show(6, -3), "-2");
    assert_eq!(show(0, 5), "0");
    assert_eq!(show(1, 0), "undefined");
    assert_eq!(Ratio::from_f64(0.1).to_string(), "3602879701896397/36028797018963968");
    let r = Ratio::new(-20, 48);
    assert_eq!(
        (r.numerator().to_string(), r.denominator().to_string()),
        ("-5".into(), "12".into())
    );
    let tiny = Ratio::from_f64(1e-300);
    assert_eq!((tiny * tiny * tiny).to_string(), "≈1.00000000000e-900");
}
