use super::gauss_legendre::step;
use super::tests::{Coupled, START, dual, matrix};
use super::*;
use crate::ImplicitMethod;
use crate::integrator::{Integrator, Rk4};
use crate::number::Dual;
use crate::system::{Differentiated, HenonHeiles, Kepler, Oscillator, Pendulum};

const METHODS: [ImplicitMethod; 2] =
    [ImplicitMethod::GaussLegendre4, ImplicitMethod::GaussLegendre6];

fn largest<const D: usize>(state: State<f64, D>) -> f64 {
    state.coordinates().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The real and the imaginary part of the diagonal Padé approximant at `iz`: `N²/|N|²` with its numerator `N`.
fn rotation(method: ImplicitMethod, z: f64) -> [f64; 2] {
    let (re, im) = match method {
        ImplicitMethod::GaussLegendre4 => (1.0 - z * z / 12.0, z / 2.0),
        _ => (1.0 - z * z / 10.0, z / 2.0 - z * z * z / 120.0),
    };
    let size = re * re + im * im;
    [(re - im) * (re + im) / size, 2.0 * re * im / size]
}

/// The largest distance of the matrix of a step from the approximant.
fn distance(method: ImplicitMethod, z: f64) -> f64 {
    let [re, im] = rotation(method, z);
    let [[a, b], [c, d]] = matrix(method, [1.0, 0.0], z);
    [a - re, b - im, c + im, d - re].into_iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

#[test]
fn update_matrices_of_the_oscillator_are_the_diagonal_pade_approximants() {
    for method in METHODS {
        for z in [0.1, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0] {
            // At most 3 units were measured.
            assert!(distance(method, z) < 8.0 * f64::EPSILON, "{method:?} {z}");
        }
    }
}

#[test]
fn a_step_of_a_hundred_radians_is_that_of_the_approximant() {
    for method in METHODS {
        // At most 4.5 units were measured, of equations with entries up to z²/4 = 2500.
        assert!(distance(method, 100.0) < 16.0 * f64::EPSILON, "{method:?}");
    }
}

#[test]
fn a_nonlinear_step_is_that_of_mpmath_with_40_digits() {
    // Three units in the last place of numbers up to 2.5. `findroot` of mpmath 1.4 on the equations of the stages, with √3 and √15 to 40 digits.
    let wanted = [
        [
            1.996_328_025_108_553,
            0.178_226_135_522_927_8,
            0.049_442_094_242_040_5,
            2.519_248_062_055_043,
        ],
        [
            1.996_254_221_481_161_2,
            0.177_854_615_439_895_1,
            0.049_467_828_537_067_04,
            2.519_642_917_851_548,
        ],
    ];
    for (method, [a, b, u, w]) in METHODS.into_iter().zip(wanted) {
        let end = method.step(&Differentiated(Coupled), START, 0.3);
        let off = largest(end.plus(-1.0, State { q: [a, b], v: [u, w] }));
        assert!(off < 1.4e-15, "{method:?} {off}");
    }
}

#[test]
fn errors_after_a_period_of_an_ellipse_fall_with_orders_4_and_6() {
    // Half the major axis 1 and eccentricity 0.3, from the pericentre: after 2π s the start is the solution.
    let system = Differentiated(Kepler::<Dual<f64>> { mu: dual(1.0) });
    let start = State { q: [0.7, 0.0], v: [0.0, (1.3_f64 / 0.7).sqrt()] };
    for method in METHODS {
        let error = |steps: u32| {
            let h = core::f64::consts::TAU / f64::from(steps);
            let end = (0..steps).fold(start, |state, _| method.step(&system, state, h));
            largest(end.plus(-1.0, start))
        };
        let order = (error(80) / error(160)).log2();
        // 3.997 and 6.001 were measured; errors are above 2·10⁻¹⁰.
        assert!((order - f64::from(method.order())).abs() < 0.01, "{method:?} {order}");
    }
}

#[test]
fn steps_of_nonlinear_forces_are_symplectic() {
    let number = |x| Dual::constant(dual(x));
    let system = Differentiated(HenonHeiles::<Dual<Dual<f64>>> { lambda: number(1.0) });
    let start = State { q: [0.3, -0.2], v: [0.3, 0.15] };
    for method in METHODS {
        let columns: [State<f64, 2>; 4] = core::array::from_fn(|j| {
            let mut state = start.map(dual);
            let [a, b] = &mut state.q;
            let [u, w] = &mut state.v;
            [a, b, u, w][j].du = 1.0;
            method.step(&system, state, dual(0.5)).map(|x| x.du)
        });
        for (i, x) in columns.iter().enumerate() {
            for (j, y) in columns.iter().enumerate() {
                let area: f64 = (0..2).map(|d| x.q[d] * y.v[d] - x.v[d] * y.q[d]).sum();
                let wanted = f64::from(u8::from(j == i + 2)) - f64::from(u8::from(i == j + 2));
                // Sums of four products of numbers of about 1.
                assert!((area - wanted).abs() < 1e-15, "{method:?} {i} {j} {area}");
            }
        }
    }
}

#[test]
fn steps_backwards_undo_steps() {
    let system = Differentiated(HenonHeiles::<Dual<f64>> { lambda: dual(1.0) });
    let start = State { q: [0.3, -0.2], v: [0.3, 0.15] };
    for method in METHODS {
        let end = method.step(&system, start, 0.5);
        let off = largest(method.step(&system, end, -0.5).plus(-1.0, start));
        // A unit in the last place of 0.3, and roundings of two steps.
        assert!(off < 2e-16, "{method:?} {off}");
    }
}

#[test]
fn the_energy_of_an_oscillator_is_conserved_over_a_hundred_thousand_steps() {
    for method in METHODS {
        for z in [0.1, 0.3, 0.7, 1.0, 1.5, 2.0, 3.0, 10.0, 100.0] {
            let system = Differentiated(Oscillator::<Dual<f64>> { omega2: dual(z * z) });
            let energy =
                |state: &State<f64, 1>| z * z * state.q[0] * state.q[0] + state.v[0] * state.v[0];
            let first = State { q: [1.0], v: [0.5 * z] };
            let last = (0..100_000).fold(first, |state, _| method.step(&system, state, 1.0));
            let drift = energy(&last) / energy(&first) - 1.0;
            // Each step rounds by some units in the last place, at random: 4·10⁻¹³ was measured. Rounded weights would add 10⁻¹¹.
            let bound = 20.0 * f64::EPSILON * 1e5_f64.sqrt();
            assert!(drift.abs() < bound, "{method:?} {z} {drift}");
        }
    }
}

#[test]
fn five_newton_steps_suffice_for_a_pendulum_in_steps_of_two_radians() {
    let system = Differentiated(Pendulum::<Dual<f64>> { omega2: dual(1.0) });
    let off = |four: bool, h: f64| {
        let mut start = State { q: [0.0], v: [(2.0 * (1.0 - 2.0_f64.cos())).sqrt()] };
        let mut most: f64 = 0.0;
        for _ in 0..200 {
            let end = |count| match four {
                true => step(GaussLegendre4, &system, start, h, count),
                false => step(GaussLegendre6, &system, start, h, count),
            };
            most = most.max(largest(end(NEWTON_STEPS).plus(-1.0, end(2 * NEWTON_STEPS))));
            start = Rk4.step(&Pendulum { omega2: 1.0 }, start, 0.05);
        }
        most
    };
    for four in [true, false] {
        for h in [0.5, 1.0, 2.0] {
            // Roundings of velocities up to 1.7.
            assert!(off(four, h) < 2e-15, "{four} {h} {}", off(four, h));
        }
    }
    // Fewer would not.
    let start = State { q: [0.0], v: [(2.0 * (1.0 - 2.0_f64.cos())).sqrt()] };
    let of = |count| step(GaussLegendre4, &system, start, 0.5, count);
    assert!(largest(of(2).plus(-1.0, of(4))) > 1e-9, "{}", largest(of(2).plus(-1.0, of(4))));
}
