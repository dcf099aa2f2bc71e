use astro_float_num::{BigFloat, Consts, RoundingMode::ToEven};
use libration::number::{Ratio, Wide};
use libration::{Elementary, Scalar};
use proptest::prelude::*;

use crate::exp2;

/// Precision of the oracle.
const P: usize = 1344;

/// The exact value: 53 bits at a time, from 2⁵⁰⁰ down so that no part is subnormal.
fn oracle(w: Wide) -> BigFloat {
    let shift = w.exponent().unwrap_or(0) - 500;
    let mut rest = w.scaled(-shift);
    let mut sum = BigFloat::new(P);
    while !rest.is_zero() {
        let part = rest.to_f64();
        sum = sum.add(&BigFloat::from_f64(part, P), P, ToEven);
        rest = rest - Wide::from_f64(part);
    }
    if let Some(exponent) = sum.exponent() {
        sum.set_exponent(exponent + shift as i32);
    }
    sum
}

/// Whether `|computed − exact| ≤ 2^−bits · (1 + 2⁻⁵⁰) · |reference|`.
fn close(computed: Wide, exact: &BigFloat, bits: i32, reference: &BigFloat) -> bool {
    let mut difference = oracle(computed).sub(exact, P, ToEven);
    match difference.exponent() {
        Some(exponent) if !difference.is_zero() => difference.set_exponent(exponent + bits),
        _ => {}
    }
    let slack = BigFloat::from_f64(1.0 + exp2(-50), P);
    difference.abs().cmp(&reference.abs().mul(&slack, P, ToEven)).is_some_and(|order| order <= 0)
}

/// Whether the relative error is at most `2^−bits`.
fn agrees(computed: Wide, exact: &BigFloat, bits: i32) -> bool {
    close(computed, exact, bits, exact)
}

/// Numbers with all 1024 bits in use.
fn wide(exponents: core::ops::Range<i64>) -> impl Strategy<Value = Wide> {
    (any::<[u64; 20]>(), exponents, any::<bool>()).prop_map(|(words, exponent, negative)| {
        let w = words
            .iter()
            .fold(Wide::one(), |w, &x| w.scaled(-53) + Wide::from_f64((x >> 11) as f64));
        let w = w.scaled(exponent - w.exponent().unwrap_or(0));
        if negative { -w } else { w }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn arithmetic_agrees_with_the_oracle(a in wide(-300..300), b in wide(-300..300)) {
        let (x, y) = (oracle(a), oracle(b));
        prop_assert!(agrees(a + b, &x.add(&y, 2200, ToEven), 1024));
        prop_assert!(agrees(a - b, &x.sub(&y, 2200, ToEven), 1024));
        prop_assert!(agrees(a * b, &x.mul(&y, 2200, ToEven), 1024));
        prop_assert!(agrees(a / b, &x.div(&y, P, ToEven), 1022));
        // The divisor is short, as those of fractions are.
        let short = Wide::from_f64(b.to_f64());
        prop_assert!(agrees(a / short, &x.div(&oracle(short), P, ToEven), 1022));
        prop_assert!(agrees(b.recip(), &y.reciprocal(P, ToEven), 1022));
        prop_assert!(agrees(a.abs().sqrt(), &x.abs().sqrt(P, ToEven), 1022));
        prop_assert_eq!(a.partial_cmp(&b), x.partial_cmp(&y));
    }

    #[test]
    fn sums_that_cancel_stay_accurate(a in wide(-3..3), c in wide(-3..3), k in 0..1200_i64) {
        let b = -(a + c.scaled(-k));
        prop_assert!(agrees(a + b, &oracle(a).add(&oracle(b), 2600, ToEven), 1024));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn functions_agree_with_the_oracle(a in wide(-60..60), b in wide(-60..60)) {
        let mut constants = Consts::new().unwrap();
        let c = &mut constants;
        let (x, one) = (oracle(a), BigFloat::from_f64(1.0, P));
        let scale = if a.exponent() < Some(0) { one } else { x.clone() };
        let (sin, cos) = a.sin_cos();
        prop_assert!(close(sin, &x.sin(P, ToEven, c), 1015, &scale));
        prop_assert!(close(cos, &x.cos(P, ToEven, c), 1015, &scale));
        prop_assert!(agrees(a.abs().ln(), &x.abs().ln(P, ToEven, c), 1015));
        prop_assert!(agrees(a.abs().log10(), &x.abs().log10(P, ToEven, c), 1014));
        prop_assert!(agrees(a.atan2(Wide::one()), &x.atan(P, ToEven, c), 1015));
        // All quadrants: the angle of (x, y) has the sine y/r and the cosine x/r.
        let (sin, cos) = a.atan2(b).sin_cos();
        let r = (a * a + b * b).sqrt();
        prop_assert!((sin - a / r).abs().to_f64() < 1e-300 && (cos - b / r).abs().to_f64() < 1e-300);
        prop_assert_eq!(a.atan2(b).is_negative(), a.is_negative());
    }

    #[test]
    fn logarithms_next_to_one_keep_their_relative_accuracy(a in wide(-900..-1)) {
        let mut constants = Consts::new().unwrap();
        let x = Wide::one() + a;
        prop_assume!(x != Wide::one());
        prop_assert!(agrees(x.ln(), &oracle(x).ln(2400, ToEven, &mut constants), 1015));
    }

    #[test]
    fn repeated_squaring_is_repeated_multiplication(a in wide(-3..3), n in 0..200_u64) {
        let product = (0..n).fold(Wide::one(), |p, _| p * a);
        let error = if n == 0 { 0.0 } else { ((a.powi(n) - product) / product).abs().to_f64() };
        prop_assert!(error <= 4.0 * 200.0 * exp2(-1022));
    }
}

proptest! {
    #[test]
    fn floats_come_and_go_unchanged(bits in any::<u64>()) {
        let x = f64::from_bits(bits);
        let back = Wide::from_f64(x).to_f64();
        prop_assert!(back == x || !x.is_finite() && back.is_nan());
    }

    #[test]
    fn arithmetic_on_floats_rounds_to_the_floats_of_the_language(
        a in any::<u64>(), b in any::<u64>(),
    ) {
        // 1024 bits and then 53: double rounding is innocuous for + − × ÷ √ from 53 bits on
        // (Figueroa 1995), but not for subnormal results, which no product or quotient here has.
        let float = |bits: u64| f64::from_bits(bits >> 2 & 0xf00f_ffff_ffff_ffff | (0x380 + (bits & 0x7f)) << 52);
        let (a, b) = (float(a), float(b));
        let (x, y) = (Wide::from_f64(a), Wide::from_f64(b));
        prop_assert_eq!((x + y).to_f64(), a + b);
        prop_assert_eq!((x - y).to_f64(), a - b);
        prop_assert_eq!((x * y).to_f64(), a * b);
        prop_assert_eq!((x / y).to_f64(), a / b);
        prop_assert_eq!(x.abs().sqrt().to_f64(), a.abs().sqrt());
    }

    #[test]
    fn fractions_convert_to_the_last_place(n in any::<i64>(), d in 1..i64::MAX) {
        let w = Wide::from(Ratio::new(n, d));
        let product = w * Wide::from(Ratio::from(d));
        let exact = Wide::from(Ratio::from(n));
        prop_assert!(n == 0 || ((product - exact) / exact).abs().to_f64() <= exp2(-1020));
        prop_assert_eq!(w.to_f64(), Ratio::new(n, d).to_f64());
    }
}

#[test]
fn pi_agrees_with_the_oracle() {
    let pi = Consts::new().unwrap().pi(P, ToEven);
    assert!(agrees(Wide::pi(), &pi, 1024));
}

#[test]
fn a_carry_out_of_the_significand_moves_the_exponent() {
    let two = Wide::from_f64(2.0);
    let below = two - Wide::one().scaled(-1023);
    assert!(below < two);
    assert_eq!(below + Wide::one().scaled(-1024), two);
    assert_eq!(below + Wide::one().scaled(-1025), below);
}

#[test]
fn rounding_to_f64_at_ties_and_ends() {
    let one = Wide::one();
    let f = |m: f64, e: i64| Wide::from_f64(m).scaled(e);
    assert_eq!((one + f(1.0, -53)).to_f64(), 1.0);
    assert_eq!((one + f(3.0, -53)).to_f64(), 1.0 + 2.0 * f64::EPSILON);
    assert_eq!((one + f(1.0, -53) + f(1.0, -1000)).to_f64(), 1.0 + f64::EPSILON);
    assert_eq!((one + f(3.0, -53) - f(1.0, -1000)).to_f64(), 1.0 + f64::EPSILON);
    assert_eq!(f(1.0, -1075).to_f64(), 0.0);
    assert_eq!(f(1.000_001, -1075).to_f64(), f64::from_bits(1));
    assert_eq!(f(-3.0, -1075).to_f64(), -f64::from_bits(2));
    assert_eq!(f(2.5, -1074).to_f64(), f64::from_bits(2));
    assert_eq!((f(1.0, -1022) - f(1.0, -1075)).to_f64(), f64::MIN_POSITIVE);
    assert_eq!(f(1.0, -1076).to_f64(), 0.0);
    assert_eq!(f(1.0, i64::MIN / 8).to_f64(), 0.0);
    assert_eq!((f(1.0, 1024) - f(1.0, 970)).to_f64(), f64::INFINITY);
    assert_eq!((f(1.0, 1024) - f(1.001, 970)).to_f64(), f64::MAX);
    assert_eq!(f(-1.0, 5000).to_f64(), f64::NEG_INFINITY);
}

#[test]
fn decimals() {
    let f = Wide::from_f64;
    let show = |x: Wide, digits| x.to_decimal(digits);
    assert_eq!(show(f(0.0), 5), "0");
    assert_eq!(show(f(1.0), 1), "1e0");
    assert_eq!(show(f(-1.25), 3), "-1.25e0");
    assert_eq!(show(f(0.1), 17), "1.0000000000000001e-1");
    assert_eq!(show(f(9.996), 3), "1.00e1");
    assert_eq!(show(f(99_999.0), 5), "9.9999e4");
    assert_eq!(show(f(1e300), 3), "1.00e300");
    assert_eq!(show(f(f64::from_bits(1)), 6), "4.94066e-324");
    assert_eq!(show(f(10.0).powi(698_970), 12), "1.00000000000e698970");
    assert_eq!(show(f(10.0).powi(698_970).recip(), 12), "1.00000000000e-698970");
    assert_eq!(show(f(2.0).powi(1443), 17), "2.4337935909969659e434");
    assert_eq!(format!("{:.2} {}", Wide::pi(), f(-0.5)), "3.14e0 -5.0000000000000000e-1");
    assert_eq!(show(Wide::pi(), 30), "3.14159265358979323846264338328e0");
    assert!(!show(f(3.0).scaled(1 << 60), 12).contains("NaN"));
    assert_eq!(f(10.0).powi(698_970).log10().to_f64(), 698_970.0);
}

#[test]
fn what_has_no_value_is_nan_and_contagious() {
    let (zero, one) = (Wide::ZERO, Wide::one());
    let huge = one.scaled(1 << 60);
    let nans = [
        one / zero,
        zero / zero,
        zero.recip(),
        (-one).sqrt(),
        (-one).ln(),
        zero.ln(),
        huge.powi(9),
        one.scaled(i64::MAX),
        huge.sin(),
        Wide::from_f64(f64::INFINITY),
        huge.recip().powi(9),
    ];
    for nan in nans {
        assert!(nan.is_nan() && nan.to_f64().is_nan() && nan.exponent().is_none());
        assert!(nan != nan && nan.partial_cmp(&one).is_none() && !nan.is_zero());
        let more = [
            nan + one,
            one - nan,
            nan * zero,
            zero * nan,
            nan / one,
            -nan,
            nan.sqrt(),
            nan.sin(),
            nan.cos(),
            nan.ln(),
            nan.abs(),
            nan.powi(2),
            nan.scaled(3),
            nan.ratio(1, 2),
            nan.atan2(one),
            one.atan2(nan),
            nan.atan2(nan),
            zero.atan2(nan),
        ];
        assert!(more.iter().all(|x| x.is_nan()), "{more:?}");
    }
    assert_eq!(zero.atan2(zero), zero);
    assert_eq!(zero.atan2(-one), Wide::pi());
    assert_eq!(one.atan2(zero), Wide::pi().scaled(-1));
}

/// The oscillator's velocity-Verlet step with f64 constants, ωΔt = 0.1.
fn step() -> [[Wide; 2]; 2] {
    let h = Wide::from_f64(0.1);
    let c = Wide::one() - (h * h).ratio(1, 2);
    [[c, h], [-h * (Wide::one() - (h * h).ratio(1, 4)), c]]
}

fn times(a: [[Wide; 2]; 2], b: [[Wide; 2]; 2]) -> [[Wide; 2]; 2] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

#[test]
fn the_millionth_power_of_an_update_matrix_still_has_determinant_one() {
    let (mut power, mut square) = ([[Wide::one(), Wide::ZERO], [Wide::ZERO, Wide::one()]], step());
    for bit in 0..20 {
        if 1_000_000 >> bit & 1 == 1 {
            power = times(power, square);
        }
        square = times(square, square);
    }
    let determinant = power[0][0] * power[1][1] - power[0][1] * power[1][0];
    assert!((determinant - Wide::one()).abs().to_f64() < 1e-295);
    // And it is the rotation by a million times the angle of one step.
    let [[c, _], [_, _]] = step();
    let theta = ((Wide::one() - c * c).sqrt()).atan2(c);
    let angle = theta * Wide::from_f64(1e6);
    assert!((power[0][0] - angle.cos()).abs().to_f64() < 1e-295);
}

#[test]
fn what_cancels_keeps_its_digits() {
    // A rotation whose entries are rounded to f64: how far its determinant misses 1, exactly.
    let (c, s) = (0.995_004_165_278_025_8, 0.099_833_416_646_828_15);
    let miss = |x: Wide, y: Wide| (x * x + y * y - Wide::one()).to_f64();
    let (p, q) = (Ratio::from_f64(c), Ratio::from_f64(s));
    let exact = (p * p + q * q - Ratio::ONE).to_f64();
    assert!(exact != 0.0 && exact.abs() < 1e-15);
    assert_eq!(miss(Wide::from_f64(c), Wide::from_f64(s)), exact);
    // (1 + ε)² − 1 − 2ε = ε², 120 digits below the terms.
    let tiny = Wide::from_f64(1e-60);
    let w = Wide::one() + tiny;
    let square = (w * w - Wide::one() - tiny.scaled(1)).to_f64();
    assert_eq!(square, 1e-60 * 1e-60);
}
