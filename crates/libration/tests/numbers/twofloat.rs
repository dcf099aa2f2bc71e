use libration::number::{TwoFloat, Wide};
use libration::{Elementary, Float, Scalar};
use proptest::prelude::*;

use crate::{exp2, relative_error};

/// `u²` with `u = 2⁻⁵³`.
const U2: f64 = f64::EPSILON * f64::EPSILON / 4.0;

/// Numbers of both signs and many sizes, whose low part is anything from zero to half an ulp.
fn twofloat() -> impl Strategy<Value = TwoFloat> {
    let low = prop_oneof![Just(0.0), -1.0..1.0_f64, (-1.0..1.0_f64).prop_map(|x| x * exp2(-30))];
    (1.0..2.0_f64, -200..200_i32, low, any::<bool>()).prop_map(|(hi, e, lo, negative)| {
        let x = TwoFloat::from_sum(hi * exp2(e), lo * exp2(e - 53));
        if negative { -x } else { x }
    })
}

macro_rules! within {
    ($computed:expr, $exact:expr, $bound:expr) => {
        let error = relative_error(Wide::from($computed), $exact) / U2;
        prop_assert!(error <= $bound, "relative error {error} u²");
    };
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    // Bounds from Joldes, Muller and Popescu, Table 1; the terms in u³ are below 0.01 u².
    #[test]
    fn arithmetic_is_as_accurate_as_proven(a in twofloat(), b in twofloat()) {
        let (x, y) = (Wide::from(a), Wide::from(b));
        within!(a + b, x + y, 3.01);
        within!(a - b, x - y, 3.01);
        within!(a * b, x * y, 7.0);
        within!(a / b, x / y, 15.01);
        within!(b.recip(), y.recip(), 15.01);
        within!(a.abs().sqrt(), x.abs().sqrt(), 3.125);
        // A product with a float (3/2 u²), then a division.
        within!(a.ratio(-7, 3), x.ratio(-7, 3), 16.6);
    }

    #[test]
    fn a_power_of_two_divides_exactly_as_a_quotient_does(a in twofloat(), exponent in 0..31_u32) {
        let den = (1_i64 << exponent).min(1 << 30) as i32;
        let part = a.ratio(1, den);
        prop_assert_eq!(Wide::from(part), Wide::from(a).scaled(-i64::from(exponent.min(30))));
        prop_assert_eq!(part, a / TwoFloat::from_f64(den.into()));
    }

    #[test]
    fn sums_that_cancel_stay_accurate(a in twofloat(), scale in -3.0..3.0_f64, k in 20..110_i32) {
        // b is close to −a: what is left is small, and still right to 3u².
        let b = -(a * TwoFloat::from_sum(1.0, scale * exp2(-k)));
        within!(a + b, Wide::from(a) + Wide::from(b), 3.01);
    }

    #[test]
    fn sine_and_cosine_are_right_to_1e_30(x in -1e6..1e6_f64, near in -640_000..640_000_i32, low in -1.0..1.0_f64) {
        let check = |x: TwoFloat| {
            let (sin, cos) = Wide::from(x).sin_cos();
            let error = (Wide::from(x.sin()) - sin).abs().to_f64().max((Wide::from(x.cos()) - cos).abs().to_f64());
            prop_assert!(error <= 1e-30, "{x:?}: {error:e}");
            Ok(())
        };
        check(TwoFloat::from_sum(x, low * x * exp2(-54)))?;
        check(TwoFloat::from_f64(x * 1e-6))?;
        check(TwoFloat::from_f64(x * 1e9))?;
        // Next to a multiple of π/2, where the reduction cancels.
        check(TwoFloat::from_f64(f64::from(near) * core::f64::consts::FRAC_PI_2))?;
        check(TwoFloat::PI.ratio(near, 2))?;
    }

    #[test]
    fn order_is_that_of_the_values(a in twofloat(), b in twofloat(), lo in -1.0..1.0_f64) {
        prop_assert_eq!(a.partial_cmp(&b), Wide::from(a).partial_cmp(&Wide::from(b)));
        let c = TwoFloat::from_sum(a.hi(), lo * a.hi() * exp2(-54));
        prop_assert_eq!(a.partial_cmp(&c), Wide::from(a).partial_cmp(&Wide::from(c)));
    }

    #[test]
    fn the_parts_do_not_overlap(a in twofloat(), b in twofloat()) {
        for x in [a + b, a - b, a * b, a / b, a.abs().sqrt(), a.ratio(1, 3)] {
            prop_assert_eq!(x.hi() + x.lo(), x.hi());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    // Measured: at most 7u² on 20,000 arguments. 10⁻³⁰ is 81u².
    #[test]
    fn the_other_functions_are_right_to_1e_30(
        a in twofloat(), b in twofloat(), x in -600.0..600.0_f64, t in -1.0..1.0_f64, low in -1.0..1.0_f64,
    ) {
        within!(a.atan(), Wide::from(a).atan(), 81.0);
        within!(a.atan2(b), Wide::from(a).atan2(Wide::from(b)), 81.0);
        within!(a.abs().ln(), Wide::from(a.abs()).ln(), 81.0);
        for x in [x, 0.01 * x, t] {
            let x = TwoFloat::from_sum(x, low * x * exp2(-54));
            let w = Wide::from(x);
            within!(x.exp(), w.exp(), 81.0);
            within!(x.sinh(), w.sinh(), 81.0);
            within!(x.cosh(), w.cosh(), 81.0);
            within!(x.tanh(), w.tanh(), 81.0);
            // Next to one.
            let near = TwoFloat::from_f64(1.0) + TwoFloat::from_f64(t * exp2(-20));
            within!(near.ln(), Wide::from(near).ln(), 81.0);
        }
        for t in [t, t.signum() - 0.001 * t] {
            let t = TwoFloat::from_sum(t, low * t * exp2(-54));
            within!(t.tan(), Wide::from(t).tan(), 81.0);
            within!(t.asin(), Wide::from(t).asin(), 81.0);
            within!(t.acos(), Wide::from(t).acos(), 81.0);
        }
    }
}

#[test]
fn large_operands_survive_the_split() {
    // Above 2⁹⁹⁶ the splitting constant times the operand would overflow.
    let a = TwoFloat::from_sum(1.234_567e305, 1.0e288);
    let b = TwoFloat::from_sum(1.1, 1.0e-17);
    assert!(relative_error(Wide::from(a * b), Wide::from(a) * Wide::from(b)) <= 7.0 * U2);
    assert!(relative_error(Wide::from(a / b), Wide::from(a) / Wide::from(b)) <= 15.01 * U2);
    assert!(relative_error(Wide::from(a.sqrt()), Wide::from(a).sqrt()) <= 3.125 * U2);
}

#[test]
fn special_values_stay_what_they_are() {
    let zero = TwoFloat::zero();
    assert_eq!(zero.sqrt(), zero);
    assert_eq!((zero.sin(), zero.cos()), (zero, TwoFloat::one()));
    assert!(!zero.recip().is_finite());
    assert!((-TwoFloat::one()).sqrt().hi().is_nan());
    assert!(TwoFloat::from_f64(1e16).sin().hi().is_nan());
    assert!(TwoFloat::from_f64(f64::INFINITY).cos().hi().is_nan());
    let huge = TwoFloat::from_f64(1e200);
    assert!(!(huge * huge).is_finite());
    assert!(huge.is_finite());
}

#[test]
fn pi_is_rounded_to_nearest() {
    let error = (Wide::from(TwoFloat::PI) - Wide::pi()).abs().to_f64();
    assert!(error < exp2(-107), "{error:e}");
}

#[test]
fn it_is_a_float_of_106_bits() {
    assert_eq!(TwoFloat::NAME, "twofloat");
    assert_eq!(TwoFloat::UNIT_ROUNDOFF, exp2(-106));
    let next = TwoFloat::one() + TwoFloat::from_f64(exp2(-106));
    assert!(next > TwoFloat::one() && next.to_f64() == 1.0);
}
