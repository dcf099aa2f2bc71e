//! The functions of the number types that are not floats of the machine.

use libration::number::{Compensated, Dual, Mantissa, Poly, Ratio, TwoFloat, Wide};
use libration::{Elementary, Float, Scalar};

fn tf(x: f64) -> TwoFloat {
    TwoFloat::from_f64(x)
}

/// The derivative of `f` at `x` as a difference of numbers with 1024 bits.
fn slope(f: impl Fn(Wide) -> Wide, x: f64) -> Wide {
    // The difference errs by h² = 10⁻¹⁸⁰ and by the 2⁻¹⁰⁰⁰ of the values over h.
    let h = Wide::one().scaled(-300);
    let x = Wide::from_f64(x);
    (f(x + h) - f(x - h)) * h.scaled(1).recip()
}

macro_rules! derivatives {
    ($($name:ident at [$($x:expr),*])*) => {$(
        for x in [$($x),*] {
            let exact = slope(|x| x.$name(), x);
            let dual = Dual::variable(tf(x)).$name();
            assert_eq!(dual.re, tf(x).$name());
            let error = ((Wide::from(dual.du) - exact) / exact).abs().to_f64();
            // A handful of operations at 15u² = 2·10⁻³¹, and the functions' own 10⁻³⁰.
            assert!(error <= 1e-29, "derivative of {} at {x}: {error:e}", stringify!($name));
        }
    )*};
}

#[test]
fn derivatives_of_dual_numbers_are_the_differences_of_1024_bits() {
    derivatives! {
        tan at [-1.2, 0.3, 4.0]
        asin at [-0.999, -0.3, 1e-5, 0.7]
        acos at [-0.999, -0.3, 1e-5, 0.7]
        atan at [-1e5, -0.3, 0.01, 2.5]
        exp at [-20.0, -0.1, 1.0, 50.0]
        ln at [1e-20, 0.5, 1.001, 1e10]
        sinh at [-3.0, 0.01, 25.0]
        cosh at [-3.0, 0.01, 25.0]
        tanh at [-30.0, -3.0, 0.01, 1.0]
        abs at [-3.0, 0.5]
    }
    for (y, x) in [(0.3, 0.8), (2.0, -1.5), (-1.0, -3.0), (-4.0, 0.1)] {
        let found = [
            Dual::variable(tf(y)).atan2(Dual::constant(tf(x))).du,
            Dual::constant(tf(y)).atan2(Dual::variable(tf(x))).du,
        ];
        let exact =
            [slope(|y| y.atan2(Wide::from_f64(x)), y), slope(|x| Wide::from_f64(y).atan2(x), x)];
        for (found, exact) in found.into_iter().zip(exact) {
            let error = ((Wide::from(found) - exact) / exact).abs().to_f64();
            assert!(error <= 1e-29, "derivative of the angle of ({x}, {y}): {error:e}");
        }
    }
}

#[test]
fn derivatives_at_ends_corners_and_jumps_are_the_documented_ones() {
    let variable = Dual::<f64>::variable;
    let constant = Dual::<f64>::constant;
    assert_eq!(variable(1.0).asin().du, f64::INFINITY);
    assert_eq!(variable(-1.0).acos().du, f64::NEG_INFINITY);
    assert_eq!((constant(1.0).asin().du, constant(-1.0).acos().du), (0.0, 0.0));
    assert!(variable(1.5).asin().re.is_nan() && variable(1.5).asin().du.is_nan());
    assert_eq!(variable(0.0).abs(), Dual { re: 0.0, du: 0.0 });
    assert_eq!(variable(-2.0).signum(), Dual { re: -1.0, du: 0.0 });
    let other = Dual { re: 2.0, du: 7.0 };
    assert_eq!(variable(1.0).min(other), variable(1.0));
    assert_eq!(variable(3.0).min(other), other);
    assert_eq!(variable(2.0).min(other), variable(2.0));
    assert_eq!(variable(1.0).max(other), other);
    assert_eq!(variable(2.0).max(other), variable(2.0));
    assert_eq!(variable(1.0).select_less(other, other, constant(5.0)), other);
    assert_eq!(variable(2.0).select_less(other, other, constant(5.0)), constant(5.0));
    assert_eq!(variable(2.0).select_less_equal(other, other, constant(5.0)), other);
    assert_eq!(variable(2.0).select_equal(other, constant(5.0), other), constant(5.0));
    // Far from zero 1 − tanh² would be 0.
    assert!((variable(25.0).tanh().du / (4.0 * f64::exp(-50.0)) - 1.0).abs() < 1e-14);
}

#[test]
fn double_doubles_have_the_special_values_of_f64() {
    let infinity = f64::INFINITY;
    assert_eq!(tf(800.0).exp().hi(), infinity);
    assert_eq!(tf(-800.0).exp(), tf(0.0));
    assert_eq!((tf(0.0).exp(), tf(1.0).ln()), (tf(1.0), tf(0.0)));
    assert_eq!(tf(0.0).ln().hi(), -infinity);
    assert_eq!((tf(711.0).sinh().hi(), tf(-711.0).sinh().hi()), (infinity, -infinity));
    assert_eq!(tf(-711.0).cosh().hi(), infinity);
    assert!(tf(710.0).cosh().is_finite());
    assert_eq!((tf(1e3).tanh(), tf(-1e3).tanh()), (tf(1.0), tf(-1.0)));
    assert!(tf(-1.0).ln().hi().is_nan() && tf(1.5).asin().hi().is_nan());
    assert!(TwoFloat::from_sum(1.0, 1e-30).acos().hi().is_nan() && tf(1e16).tan().hi().is_nan());
    assert_eq!(
        (tf(0.0).atan2(tf(-1.0)).hi(), tf(0.0).atan2(tf(0.0))),
        (TwoFloat::PI.hi(), tf(0.0))
    );
    assert_eq!(tf(infinity).atan().hi(), std::f64::consts::FRAC_PI_2);
    assert_eq!(tf(1.0).acos(), tf(0.0));
    let half_turn = Wide::from(tf(-1.0).acos()) - Wide::pi();
    assert!(half_turn.abs().to_f64() < 1e-31);
    // Signs, and an order that the low parts decide.
    let above = TwoFloat::from_sum(1.0, 1e-20);
    assert_eq!((above.min(tf(1.0)), tf(1.0).max(above)), (tf(1.0), above));
    assert_eq!(tf(1.0).select_less(above, tf(2.0), tf(3.0)), tf(2.0));
    assert_eq!(tf(1.0).select_equal(above, tf(2.0), tf(3.0)), tf(3.0));
    assert_eq!(((-above).signum(), Elementary::abs(-above)), (tf(-1.0), above));
    assert!(above.min(tf(f64::NAN)).hi().is_nan() && tf(f64::NAN).max(above).hi().is_nan());
    // The low part of this infinity is NaN.
    let overflowed = TwoFloat::from_sum(infinity, 0.0);
    assert_eq!(overflowed.max(above).hi(), infinity);
    assert_eq!(above.select_less(overflowed, tf(2.0), tf(3.0)), tf(2.0));
}

#[test]
fn wide_numbers_have_no_infinity_and_nan_for_what_is_undefined() {
    let wide = Wide::from_f64;
    assert!(wide(3000.0).exp().is_nan() && wide(0.0).ln().is_nan() && wide(1.5).acos().is_nan());
    assert_eq!(
        (wide(0.0).sinh(), wide(0.0).tanh(), wide(0.0).cosh()),
        (wide(0.0), wide(0.0), wide(1.0))
    );
    assert_eq!(
        (wide(-0.5).signum(), wide(0.0).signum(), wide(3.0).signum()),
        (wide(-1.0), wide(0.0), wide(1.0))
    );
    assert_eq!((wide(1.0).min(wide(2.0)), wide(1.0).max(wide(2.0))), (wide(1.0), wide(2.0)));
    assert!(wide(1.0).min(Wide::NAN).is_nan() && Wide::NAN.max(wide(1.0)).is_nan());
    assert_eq!(wide(1.0).select_less(wide(2.0), wide(3.0), wide(4.0)), wide(3.0));
    assert_eq!(wide(1.0).select_equal(wide(2.0), wide(3.0), wide(4.0)), wide(4.0));
    assert_eq!(Wide::NAN.select_less(wide(2.0), wide(3.0), wide(4.0)), wide(4.0));
}

#[test]
fn a_float_of_53_bits_has_the_functions_of_f64_and_shorter_ones_round_them() {
    for i in -40..40 {
        let x = 0.07 * f64::from(i);
        macro_rules! check {
            ($($name:ident)*) => {$(
                let exact: f64 = Elementary::$name(x);
                assert_eq!(Mantissa::<53>::from_f64(x).$name().to_f64().to_bits(), exact.to_bits());
                let short = Mantissa::<24>::from_f64(x);
                let exact: f64 = Elementary::$name(short.to_f64());
                assert_eq!(short.$name().to_f64().to_bits(), f64::from(exact as f32).to_bits());
            )*};
        }
        check!(tan asin acos atan exp ln sinh cosh tanh abs signum);
    }
    let [one, two] = [1.0, 2.0].map(Mantissa::<8>::from_f64);
    assert_eq!((one.min(two), one.max(two), one.select_less(two, two, one)), (one, two, two));
    assert_eq!(two.select_equal(two, one, two), one);
}

#[test]
fn compensated_numbers_have_the_functions_of_their_values_and_an_order_of_both_parts() {
    let c = Compensated::from_f64;
    assert_eq!(c(0.3).tanh().to_f64(), f64::from(Elementary::tanh(0.3_f32)));
    assert_eq!(c(0.3).atan2(c(-2.0)).to_f64(), f64::from(Elementary::atan2(0.3_f32, -2.0)));
    let above = c(1.0) + c(1e-9);
    assert_eq!((above.min(c(1.0)), c(1.0).max(above)), (c(1.0), above));
    assert_eq!((-above).abs(), above);
    assert_eq!((-above).signum(), c(-1.0));
    assert_eq!(c(1.0).select_less(above, c(2.0), c(3.0)), c(2.0));
    assert_eq!(c(1.0).select_equal(above, c(2.0), c(3.0)), c(3.0));
    assert!(above.min(c(f64::NAN)).to_f64().is_nan() && c(f64::NAN).max(above).to_f64().is_nan());
}

#[test]
fn polynomials_are_chosen_by_exact_constants_and_are_undefined_otherwise() {
    type P = Poly<3>;
    let (z, c) = (P::unknown(), |n| P::constant(Ratio::from(n)));
    for undefined in
        [z.tan(), z.abs(), z.signum(), z.min(c(1)), c(1).max(z), c(1).exp(), c(1).atan2(c(2))]
    {
        assert!(!undefined.is_valid());
    }
    assert!(!z.select_less(c(0), c(1), c(2)).is_valid());
    assert_eq!(c(1).select_less(c(2), z, c(0)), z);
    assert_eq!(c(2).select_equal(c(1), z, c(0)), c(0));
    assert_eq!((c(-3).abs(), c(-3).signum(), c(0).signum()), (c(3), c(-1), c(0)));
    assert_eq!((c(1).min(c(2)), c(1).max(c(2))), (c(1), c(2)));
}
