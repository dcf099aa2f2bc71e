//! The energy functions, and the energy of the exact motion.

use std::iter::zip;

use libration::number::Dual;
use libration::system::Kepler;
use libration::{AnySystem, Float, Hamiltonian, Model, State, System, with_system};

use crate::case::{Case, Point};

/// The energy, and the size of the terms that it is a sum of.
fn energy<const D: usize>(model: impl Model<D>, point: &Point) -> (f64, f64) {
    let state = point.state::<D>();
    let kinetic = state.v.iter().map(|v| v * v).sum::<f64>();
    let energy = model.on::<f64>().energy(&state);
    (energy, 1.0 + kinetic + energy.abs())
}

/// Against 50 digits. The state is rounded and then some ten operations are: 64 roundings bound
/// both generously.
#[test]
fn energies_are_exact_up_to_rounding() {
    for case in Case::all() {
        for point in [&case.start, &case.end] {
            let (energy, size) = with_system!(
                case.system,
                case.dimension(),
                |model, D| energy::<D>(model, point),
                panic!("{} does not exist in that dimension", case.name)
            );
            let tolerance = 64.0 * f64::UNIT_ROUNDOFF * size;
            assert!(
                (energy - point.energy).abs() <= tolerance,
                "{}: {energy} is not {} within {tolerance}",
                case.name,
                point.energy
            );
        }
    }
}

/// `dE/dt` along the equation of motion, and the size of the terms that it is a sum of.
fn power<const D: usize>(model: impl Model<D>, state: State<f64, D>) -> (f64, f64) {
    let rate = model.on::<f64>().rate(state);
    let along = |x: [f64; D], dx: [f64; D]| std::array::from_fn(|i| Dual { re: x[i], du: dx[i] });
    let moving = State { q: along(state.q, rate.q), v: along(state.v, rate.v) };
    let size = zip(rate.q, rate.v).map(|(v, a)| (v * a).abs()).sum::<f64>();
    (model.on::<Dual<f64>>().energy(&moving).du, size)
}

/// The power that a system gains, from the textbook.
fn expected_power(system: AnySystem, q: &[f64], v: &[f64]) -> f64 {
    match system {
        AnySystem::DampedOscillator(s) => -s.gamma * v[0] * v[0],
        AnySystem::DrivenOscillator(s) => {
            (s.amplitude * (s.drive * q[1]).cos() - s.gamma * v[0]) * v[0]
        }
        _ => 0.0,
    }
}

/// `v·(a + ∇V)` vanishes for every `v` only if the force is the gradient of the potential.
///
/// Nothing but rounding stands between the two sides: some ten operations on terms of that size.
#[test]
fn the_force_is_the_gradient_of_the_potential() {
    fn at<const D: usize>(system: AnySystem, model: impl Model<D>, point: &Point) {
        let (power, size) = power::<D>(model, point.state());
        let expected = expected_power(system, &point.q, &point.v);
        let tolerance = 64.0 * f64::UNIT_ROUNDOFF * (1.0 + size);
        assert!(
            (power - expected).abs() <= tolerance,
            "{}: dE/dt = {power}, not {expected} within {tolerance}, at {:?}, {:?}",
            system.name(),
            point.q,
            point.v
        );
    }
    // Knuth's MMIX generator: magnitudes from 1/2 to 3/2, clear of Kepler's singularity.
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let magnitude = 0.5 + (seed >> 11) as f64 / (1_u64 << 53) as f64;
        if seed & (1 << 40) == 0 { magnitude } else { -magnitude }
    };
    for case in Case::all() {
        let dimension = case.dimension();
        for _ in 0..100 {
            let q = (0..dimension).map(|_| random()).collect();
            let mut v: Vec<f64> = (0..dimension).map(|_| random()).collect();
            if matches!(case.system, AnySystem::DrivenOscillator(_)) {
                v[1] = 1.0;
            }
            let point = Point { q, v, energy: f64::NAN };
            with_system!(
                case.system,
                dimension,
                |model, D| at::<D>(case.system, model, &point),
                panic!("{} does not exist in that dimension", case.name)
            );
        }
    }
}

/// Semi-major axis 1 means the energy `−μ/2`, eccentricity `e` the squared angular momentum
/// `μ(1 − e²)`: Goldstein, Poole, Safko, Classical Mechanics, 3rd ed., §3.7. The terms grow like
/// `μ/(1 − e)` and lose some ten roundings.
#[test]
fn kepler_starts_at_perihelion_of_the_orbit_with_semi_major_axis_1() {
    for mu in [0.5, 1.0, 3.0] {
        for e in [0.0, 0.1, 0.6, 0.99] {
            let kepler = Kepler { mu };
            let start = kepler.perihelion(e);
            let tolerance = 16.0 * f64::UNIT_ROUNDOFF * mu / (1.0 - e);
            let energy = Hamiltonian::<f64, 2>::energy(&kepler, &start);
            assert!((energy + 0.5 * mu).abs() <= tolerance, "mu = {mu}, e = {e}: {energy}");
            let momentum = start.q[0] * start.v[1] - start.q[1] * start.v[0];
            let square = momentum * momentum;
            let expected = mu * (1.0 - e * e);
            assert!((square - expected).abs() <= tolerance, "mu = {mu}, e = {e}: {square}");
        }
    }
}
