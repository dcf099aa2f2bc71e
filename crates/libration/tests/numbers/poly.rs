use libration::number::{Poly, Ratio, Wide};
use libration::system::Oscillator;
use libration::{Scalar, State, System};
use proptest::prelude::*;

use crate::relative_error;

const YOSHIDA4: [f64; 3] = [1.3512071919596578, -1.7024143839193153, 1.3512071919596578];

/// Yoshida's sixth-order solution A (Phys. Lett. A 150 (1990) 262).
const YOSHIDA6: [f64; 7] = [
    0.784513610477560,
    0.235573213359357,
    -1.17767998417887,
    1.31518632068391,
    -1.17767998417887,
    0.235573213359357,
    0.784513610477560,
];

/// The update matrix of velocity-Verlet substeps on `q̈ = −q`, by columns.
fn matrix<S: Scalar>(weights: &[f64], h: S) -> [State<S, 1>; 2] {
    let oscillator = Oscillator { omega2: S::one() };
    [(S::one(), S::zero()), (S::zero(), S::one())].map(|(q, v)| {
        weights.iter().fold(State { q: [q], v: [v] }, |state, &w| {
            let dt = S::from_f64(w) * h;
            let half = dt.ratio(1, 2);
            state.kick(&oscillator, half).drift(dt).kick(&oscillator, half)
        })
    })
}

fn determinant<S: Scalar>([a, b]: [State<S, 1>; 2]) -> S {
    a.q[0] * b.v[0] - b.q[0] * a.v[0]
}

fn trace<S: Scalar>([a, b]: [State<S, 1>; 2]) -> S {
    a.q[0] + b.v[0]
}

#[test]
fn verlet_has_its_textbook_matrix() {
    let [a, b] = matrix(&[1.0], Poly::<8>::unknown());
    assert_eq!(a.q[0].to_string(), "1 − z²/2");
    assert_eq!(a.v[0].to_string(), "−z + z³/4");
    assert_eq!(b.q[0].to_string(), "z");
    assert_eq!(b.v[0], a.q[0]);
    assert_eq!(determinant([a, b]), Poly::one());
    assert_eq!(trace([a, b]).to_string(), "2 − z²");
}

#[test]
fn yoshida_4_preserves_area_exactly_whatever_its_weights() {
    let m = matrix(&YOSHIDA4, Poly::<24>::unknown());
    assert_eq!(determinant(m), Poly::one());
    let trace = trace(m);
    assert_eq!(trace.degree(), Some(6));
    // 2 cos z up to the order 4 of the method: the rounding of the weights leaves 1e-15.
    for (k, c) in [(0, 2.0), (2, -1.0), (4, 1.0 / 12.0)] {
        assert!((trace.coefficient(k).to_f64() - c).abs() < 1e-15, "z^{k}");
    }
    // From the product of the three matrices, worked out in another system of exact fractions.
    assert_eq!(trace.coefficient(6).to_f64(), 0.129_508_399_009_355_3);
    let shown = trace.to_string();
    assert!(shown.starts_with("2 − ≈1.00000000000·z² + ≈0.0833333333333·z⁴ + ≈0.12"), "{shown}");
}

#[test]
fn yoshida_6_fits_a_polynomial_of_degree_31() {
    let m = matrix(&YOSHIDA6, Poly::<32>::unknown());
    assert_eq!(determinant(m), Poly::one());
    assert_eq!(trace(m).degree(), Some(14));
    assert!((trace(m).coefficient(6).to_f64() + 2.0 / 720.0).abs() < 1e-13);
}

#[test]
fn the_matrix_at_a_number_is_the_step_run_on_that_number() {
    let h = 0.3;
    let poly = matrix(&YOSHIDA4, Poly::<8>::unknown());
    let exact = matrix(&YOSHIDA4, Ratio::from_f64(h));
    let wide = matrix(&YOSHIDA4, Wide::from_f64(h));
    for (p, (e, w)) in poly.iter().zip(exact.iter().zip(&wide)) {
        for (p, (e, w)) in p.coordinates().zip(e.coordinates().zip(w.coordinates())) {
            assert_eq!(p.eval(Ratio::from_f64(h)), e);
            // Eight terms of magnitude about 1, each with a rounding or two.
            assert!(relative_error(p.eval_wide(Wide::from_f64(h)), Wide::from(e)) < 1e-305);
            assert!(relative_error(w, Wide::from(e)) < 1e-305);
            assert!((p.eval_f64(h) - e.to_f64()).abs() < 16.0 * f64::EPSILON);
        }
    }
}

/// Classical Runge–Kutta, with the most temporaries of all the integrators.
fn rk4<S: Scalar>(state: State<S, 1>, h: S) -> State<S, 1> {
    let oscillator = Oscillator { omega2: S::one() };
    let half = h.ratio(1, 2);
    let k1 = oscillator.rate(state);
    let k2 = oscillator.rate(state.plus(half, k1));
    let k3 = oscillator.rate(state.plus(half, k2));
    let k4 = oscillator.rate(state.plus(h, k3));
    state.plus(h.ratio(1, 6), k1 + (k2 + k3).doubled() + k4)
}

#[test]
fn runge_kutta_is_the_truncated_exponential() {
    let start = State { q: [Poly::<32>::one()], v: [Poly::zero()] };
    let end = rk4(start, Poly::unknown());
    assert_eq!(end.q[0].to_string(), "1 − z²/2 + z⁴/24");
    assert_eq!(end.v[0].to_string(), "−z + z³/6");
    let determinant = end.q[0] * end.q[0] + end.v[0] * end.v[0];
    assert_eq!(determinant.to_string(), "1 − z⁶/72 + z⁸/576");
}

fn poly() -> impl Strategy<Value = Poly<16>> {
    prop::collection::vec((any::<i32>(), 1..99_i64), 0..6).prop_map(|c| {
        let mut p = [Ratio::ZERO; 16];
        for (p, (n, d)) in p.iter_mut().zip(c) {
            *p = Ratio::new(n.into(), d);
        }
        Poly::new(p)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn polynomials_are_a_ring(a in poly(), b in poly(), c in poly(), n in -9..9_i64, d in 1..9_i64) {
        prop_assert_eq!(a + b, b + a);
        prop_assert_eq!(a * b, b * a);
        prop_assert_eq!((a * b) * c, a * (b * c));
        prop_assert_eq!(a * (b + c), a * b + a * c);
        prop_assert_eq!(a - b + b, a);
        prop_assert_eq!(a - a, Poly::ZERO);
        prop_assert_eq!(a * Poly::one(), a);
        let z = Ratio::new(n, d);
        prop_assert_eq!((a * b).eval(z), a.eval(z) * b.eval(z));
        prop_assert_eq!((a * b).derivative(), a.derivative() * b + a * b.derivative());
        prop_assert!((a * b * c).is_valid());
    }
}

#[test]
fn a_product_of_too_high_degree_is_detected() {
    let z = Poly::<4>::unknown();
    let cube = z * z * z;
    assert_eq!(cube.degree(), Some(3));
    assert!(cube.is_valid());
    let bad = cube * z;
    assert!(!bad.is_valid() && bad.checked().is_none());
    for p in [
        bad + z,
        z - bad,
        bad * Poly::ZERO,
        Poly::ZERO * bad,
        -bad,
        bad.ratio(1, 2),
        bad.derivative(),
    ] {
        assert_eq!(p, Poly::UNDEFINED);
    }
    assert!(bad.eval_f64(1.0).is_nan() && bad.eval_wide(Wide::one()).is_nan());
    assert_eq!(bad.eval(Ratio::ONE), Ratio::UNDEFINED);
    assert_eq!(bad.coefficient(9), Ratio::UNDEFINED);
    assert_eq!(bad.to_string(), "undefined");
    assert!(!Poly::<1>::unknown().is_valid());
    assert_eq!(Poly::<4>::from_f64(f64::INFINITY), Poly::UNDEFINED);
    assert!(!z.ratio(1, 0).is_valid());
}

#[test]
fn display_reads_like_a_textbook() {
    let r = Ratio::new;
    let show = |c: [Ratio; 13]| Poly::new(c).to_string();
    let mut c = [Ratio::ZERO; 13];
    assert_eq!(show(c), "0");
    (c[0], c[2], c[4]) = (r(1, 1), r(-1, 2), r(1, 24));
    assert_eq!(show(c), "1 − z²/2 + z⁴/24");
    (c[0], c[1], c[12]) = (r(-2, 3), r(-1, 1), r(5, 7));
    assert_eq!(show(c), "−2/3 − z − z²/2 + z⁴/24 + 5z¹²/7");
    let mut c = [Ratio::ZERO; 13];
    c[3] = -(Ratio::from_f64(0.1) * Ratio::from_f64(0.1));
    assert_eq!(show(c), "−≈0.0100000000000·z³");
    c[3] = c[3] * r(12_345_678, 1);
    assert_eq!(show(c), "−≈123456.780000·z³");
    c[3] = c[3] * r(1, 1 << 40);
    assert_eq!(show(c), "−≈1.12283287308e-7·z³");
}
