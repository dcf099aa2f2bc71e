use super::newton::increment;
use super::*;
use crate::integrator::{Integrator, Rk4};
use crate::number::Dual;
use crate::system::{DampedOscillator, Differentiated, HenonHeiles, Oscillator, Pendulum};
use crate::{AnyMethod, Elementary, ImplicitMethod, Method, System};

pub(super) type Rows = [[f64; 2]; 2];

/// The matrix of a step, from the columns of the unit vectors.
pub(super) fn matrix(method: ImplicitMethod, [omega2, gamma]: [f64; 2], h: f64) -> Rows {
    let system =
        Differentiated(DampedOscillator::<Dual<f64>> { omega2: dual(omega2), gamma: dual(gamma) });
    let [a, b] =
        [[1.0, 0.0], [0.0, 1.0]].map(|[q, v]| method.step(&system, State { q: [q], v: [v] }, h));
    [[a.q[0], b.q[0]], [a.v[0], b.v[0]]]
}

pub(super) fn dual(x: f64) -> Dual<f64> {
    Dual::constant(x)
}

/// `D(hA)⁻¹N(hA)` for the diagonal Padé approximant `N/D` of the exponential function, with these coefficients of `N`, and `D(z) = N(−z)`.
///
/// Hairer and Wanner: Solving Ordinary Differential Equations II, 2nd ed., §IV.3.
fn pade(coefficients: &[f64], [omega2, gamma]: [f64; 2], h: f64) -> Rows {
    let product = |[[a, b], [c, d]]: Rows, [[e, f], [g, i]]: Rows| {
        [[a * e + b * g, a * f + b * i], [c * e + d * g, c * f + d * i]]
    };
    let polynomial = |h: f64| {
        coefficients.iter().rev().fold([[0.0; 2]; 2], |sum, &c| {
            let [[a, b], [e, f]] = product(sum, [[0.0, h], [-h * omega2, -h * gamma]]);
            [[a + c, b], [e, f + c]]
        })
    };
    let [[a, b], [c, d]] = polynomial(-h);
    let inverse = [[d, -b], [-c, a]].map(|row| row.map(|x| x / (a * d - b * c)));
    product(inverse, polynomial(h))
}

/// The coefficients of the numerators of the diagonal Padé approximants of degrees 2 and 3.
const PADE: [&[f64]; 2] = [&[1.0, 0.5, 1.0 / 12.0], &[1.0, 0.5, 0.1, 1.0 / 120.0]];

#[test]
fn update_matrices_on_the_damped_oscillator_are_those_derived_by_hand() {
    for [w, gamma, h] in [[7.0, 0.3, 0.11], [1.0, 0.0, 1.5], [2.0, 40.0, 3.0], [-1.0, 0.5, 0.2]] {
        let (g, s) = (gamma * h, h * h * w);
        let over = |den: f64, rows: Rows| rows.map(|row| row.map(|x| x / den));
        let backward = over(1.0 + g + s, [[1.0 + g, h], [-h * w, 1.0]]);
        // (1 − hA/2)⁻¹(1 + hA/2).
        let cayley = over(
            1.0 + g / 2.0 + s / 4.0,
            [[1.0 + g / 2.0 - s / 4.0, h], [-h * w, 1.0 - g / 2.0 - s / 4.0]],
        );
        for method in ImplicitMethod::ALL {
            let wanted = match method {
                ImplicitMethod::DampingImplicit => over(1.0 + g, [[1.0 + g - s, h], [-h * w, 1.0]]),
                ImplicitMethod::StablePd => {
                    over(1.0 + g, [[1.0 + g - s, h * (1.0 - s)], [-h * w, 1.0 - s]])
                }
                ImplicitMethod::DampingStiffnessImplicit | ImplicitMethod::BackwardEuler => {
                    backward
                }
                ImplicitMethod::ImplicitMidpoint | ImplicitMethod::Trapezoid => cayley,
                ImplicitMethod::GaussLegendre4 => pade(PADE[0], [w, gamma], h),
                ImplicitMethod::GaussLegendre6 => pade(PADE[1], [w, gamma], h),
            };
            let found = matrix(method, [w, gamma], h);
            let largest = wanted.as_flattened().iter().fold(1.0, |a: f64, b| a.max(b.abs()));
            for (found, wanted) in found.as_flattened().iter().zip(wanted.as_flattened()) {
                // Some ten roundings of entries that are sums of others.
                let rounding = 20.0 * f64::EPSILON * largest * (1.0 + s.abs());
                assert!((found - wanted).abs() < rounding, "{method:?} {found} {wanted}");
            }
        }
    }
}

/// A damped pendulum with a coordinate beside it that it drives, so that nothing about it is linear or symmetric.
#[derive(Clone, Copy)]
pub(super) struct Coupled;

impl<S: Elementary> System<S, 2> for Coupled {
    fn acceleration(&self, &State { q: [a, b], v: [u, w] }: &State<S, 2>) -> [S; 2] {
        let number = S::from_f64;
        [
            -(a.sin() * number(2.0)) - u * w.cos() * number(0.3),
            (a - b) * number(3.0) - w * w * w * number(0.2) + u * number(0.1),
        ]
    }
}

pub(super) const START: State<f64, 2> = State { q: [1.9, -0.4], v: [0.6, 1.1] };

#[test]
fn steps_solve_the_equations_that_define_them() {
    let system = Differentiated(Coupled);
    let rate = |state: &State<f64, 2>| System::<f64, 2>::rate(&Coupled, *state);
    let h = 0.3;
    // y' − y − h·f, whose terms are about 1.
    let check = |end: State<f64, 2>, f: State<f64, 2>| {
        let wanted = START.plus(h, f);
        for (found, wanted) in end.coordinates().zip(wanted.coordinates()) {
            assert!((found - wanted).abs() < 2e-15, "{found} {wanted}");
        }
    };
    let end = BackwardEuler.step(&system, START, h);
    check(end, rate(&end));
    let end = ImplicitMidpoint.step(&system, START, h);
    check(end, rate(&(START + end).map(|x| 0.5 * x)));
    let end = Trapezoid.step(&system, START, h);
    check(end, (rate(&START) + rate(&end)).map(|x| 0.5 * x));
}

#[test]
fn errors_fall_with_the_order_of_the_method() {
    let system = Differentiated(Coupled);
    let end = |method: AnyMethod, steps: u32| {
        (0..steps).fold(START, |state, _| method.step(&system, state, 1.0 / f64::from(steps)))
    };
    let exact = end(Method::Rk4.into(), 4000);
    for method in AnyMethod::all() {
        let error = |steps| {
            let off = end(method, steps).plus(-1.0, exact);
            off.coordinates().fold(0.0, |sum, x| sum + x * x).sqrt()
        };
        // With more steps the errors of higher orders are roundings.
        let steps = if method.order() == 6 { 20 } else { 200 };
        let order = (error(steps) / error(2 * steps)).log2();
        // Splittings fall to order 1 where forces depend on velocities; the next term is a hundredth of the first.
        let wanted = match method {
            AnyMethod::Implicit(method) => f64::from(method.order()),
            AnyMethod::Explicit(Method::Rk4) => 4.0,
            AnyMethod::Explicit(_) => 1.0,
        };
        assert!((order - wanted).abs() < 0.05, "{method:?}: {order}");
    }
}

#[test]
fn implicit_midpoint_conserves_the_energy_of_an_oscillator_in_steps_of_any_size() {
    for z in [0.1, 1.0, 10.0, 1000.0] {
        let system = Differentiated(Oscillator::<Dual<f64>> { omega2: dual(z * z) });
        let energy =
            |state: &State<f64, 1>| z * z * state.q[0] * state.q[0] + state.v[0] * state.v[0];
        let mut state = State { q: [1.0], v: [0.5 * z] };
        let start = energy(&state);
        let steps = 10_000;
        for _ in 0..steps {
            state = ImplicitMidpoint.step(&system, state, 1.0);
        }
        // Each step rounds by some units in the last place, mostly at random.
        let bound = 20.0 * f64::EPSILON * f64::from(steps).sqrt();
        assert!(
            (energy(&state) / start - 1.0).abs() < bound,
            "{z} {}",
            energy(&state) / start - 1.0
        );
    }
}

#[test]
fn implicit_midpoint_and_trapezoid_undo_their_steps_backwards() {
    for method in [ImplicitMethod::ImplicitMidpoint, ImplicitMethod::Trapezoid] {
        let system = Differentiated(HenonHeiles::<Dual<f64>> { lambda: dual(1.0) });
        let start = State { q: [0.1, -0.2], v: [0.3, 0.15] };
        let end = method.step(&system, start, 0.2);
        let back = method.step(&system, end, -0.2);
        let off = back.plus(-1.0, start);
        assert!(off.coordinates().all(|x: f64| x.abs() < 1e-15), "{method:?} {off:?}");
    }
}

#[test]
fn newton_steps_suffice_for_a_pendulum_in_the_steps_that_the_constant_names() {
    // ω = 1, swinging by 2 rad, through the fastest and the slowest place.
    let system = Differentiated(Pendulum::<Dual<f64>> { omega2: dual(1.0) });
    let fastest = (2.0 * (1.0 - 2.0_f64.cos())).sqrt();
    let off = |h: f64| {
        let mut largest: f64 = 0.0;
        let mut start = State { q: [0.0], v: [fastest] };
        for _ in 0..200 {
            let twice = increment(&system, start, h, 2 * NEWTON_STEPS);
            let own = increment(&system, start, h, NEWTON_STEPS);
            let change = own.plus(-1.0, twice);
            largest = change.coordinates().fold(largest, |most, x| most.max(x.abs()));
            start = Rk4.step(&Pendulum { omega2: 1.0 }, start, 0.05);
        }
        largest
    };
    assert!(off(0.5) < 2e-16, "{}", off(0.5));
    assert!(off(1.0) < 1e-12, "{}", off(1.0));
    // Fewer would not.
    let start = State { q: [0.0], v: [fastest] };
    let change = increment(&system, start, 0.5, 2).plus(-1.0, increment(&system, start, 0.5, 4));
    assert!(change.q[0].abs() > 1e-10, "{change:?}");
}
