use libration::number::{Dual, Poly, Ratio, TwoFloat};
use libration::{Elementary, Scalar};
use proptest::prelude::*;

type D = Dual<TwoFloat>;

fn tf(x: f64) -> TwoFloat {
    TwoFloat::from_f64(x)
}

/// The derivative of `f` at `x` against `slope`, to the accuracy of a handful of operations.
fn check(f: impl Fn(D) -> D, x: f64, slope: TwoFloat) {
    let error = (f(D::variable(tf(x))).du - slope).abs().hi();
    let scale = 1.0 + slope.abs().hi();
    // Each operation errs by at most 15u² ≈ 2e-31, the sine by 1e-30.
    assert!(error <= 1e-29 * scale, "at {x}: error {error:e}");
}

proptest! {
    #[test]
    fn elementary_functions_have_their_textbook_derivatives(x in 0.01..10.0_f64) {
        let t = tf(x);
        check(|d| d.sqrt(), x, tf(0.5) / t.sqrt());
        check(|d| d.recip(), x, -(t * t).recip());
        check(|d| d.sin(), x, t.cos());
        check(|d| d.cos(), x, -t.sin());
        check(|d| d.sqrt().sin(), x, t.sqrt().cos() * (tf(0.5) / t.sqrt()));
        check(|d| d.sin() * d.cos(), x, (t + t).cos());
        check(|d| (d * d * d - d + D::one()).ratio(2, 3), x, (t * t).ratio(6, 3) - tf(1.0).ratio(2, 3));
    }

    #[test]
    fn the_product_rule_is_exact_on_fractions(
        a in -99..99_i64, b in -99..99_i64, c in -99..99_i64, d in -99..99_i64,
    ) {
        let r = Ratio::from;
        let product = Dual { re: r(a), du: r(b) } * Dual { re: r(c), du: r(d) };
        prop_assert_eq!(product, Dual { re: r(a * c), du: r(a * d + b * c) });
    }

    #[test]
    fn differentiating_a_polynomial_agrees_with_its_derivative(
        c in prop::array::uniform5(-99..99_i64), n in -9..9_i64, d in 1..9_i64,
    ) {
        let at = Ratio::new(n, d);
        let x = Dual::variable(at);
        let value = c.iter().rev().fold(Dual::constant(Ratio::ZERO), |sum, &c| {
            sum * x + Dual::constant(Ratio::from(c))
        });
        let poly = Poly::new(c.map(Ratio::from));
        prop_assert_eq!(value.re, poly.eval(at));
        prop_assert_eq!(value.du, poly.derivative().eval(at));
    }
}

#[test]
fn constants_have_no_derivative() {
    assert_eq!(Dual::<f64>::from_f64(3.0), Dual { re: 3.0, du: 0.0 });
    assert_eq!(Dual::constant(3.0) * Dual::variable(2.0), Dual { re: 6.0, du: 3.0 });
    assert_eq!(-Dual::variable(2.0).ratio(1, 2), Dual { re: -1.0, du: -0.5 });
}

#[test]
fn nested_duals_give_second_derivatives() {
    let x = Dual::variable(Dual::variable(Ratio::from(5)));
    assert_eq!((x * x * x).du.du, Ratio::from(30));
}
