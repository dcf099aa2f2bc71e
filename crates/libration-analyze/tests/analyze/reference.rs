//! Tests of a million steps against exact arithmetic.

use libration::{AnySystem, Method};
use libration_analyze::export::Values;
use libration_analyze::trajectory::{FloatType, Request, simulate};

use super::trajectory::from;

const STEPS: u64 = 1_000_000;

/// `ω²`, `Δt`, and the state `q, v` to which a million exact steps lead from `(1, 0)`. The
/// parameters are the doubles; the products were taken with 60 digits.
const ORBITS: [(f64, f64, Method, f64, f64); 19] = [
    (10.0, 0.001, Method::ExplicitEuler, -37.308272175259646, -454.2406557507605),
    (10.0, 0.001, Method::SymplecticEuler, -0.26437270738008034, -3.051087832139815),
    (10.0, 0.001, Method::SymplecticEulerDriftFirst, -0.26132161954794053, -3.051087832139815),
    (10.0, 0.001, Method::VelocityVerlet, -0.26284716346401044, -3.0510802044202348),
    (10.0, 0.001, Method::Rk4, -0.2615756466823381, -3.0521765693498595),
    (10.0, 0.01, Method::ExplicitEuler, 3.7253086232201374e215, -3.4553130258766735e217),
    (10.0, 0.01, Method::SymplecticEuler, 0.6686428126960209, -2.3182237862233275),
    (10.0, 0.01, Method::SymplecticEulerDriftFirst, 0.6918250505582542, -2.3182237862233275),
    (10.0, 0.01, Method::VelocityVerlet, 0.6802339316271375, -2.317644230276772),
    (10.0, 0.01, Method::Rk4, 0.879813977273135, 1.5030418435242432),
    (10.0, 0.1, Method::SymplecticEuler, -0.5281930552266821, -2.9622195678026606),
    (10.0, 0.1, Method::SymplecticEulerDriftFirst, -0.23197109844641606, -2.9622195678026606),
    (10.0, 0.1, Method::VelocityVerlet, -0.3800820768365491, -2.888164078607594),
    (10.0, 0.1, Method::Rk4, 0.0005249271092272047, -0.0028805828810130898),
    (1.0, 0.01, Method::ExplicitEuler, -5.170424904241905e21, -1.1754250727549203e20),
    (1.0, 0.01, Method::SymplecticEuler, -0.9368734759858104, 0.3450155515391568),
    (1.0, 0.01, Method::SymplecticEulerDriftFirst, -0.940323631501202, 0.3450155515391568),
    (1.0, 0.01, Method::VelocityVerlet, -0.9385985537435062, 0.3450069261503683),
    (1.0, 0.01, Method::Rk4, -0.9521556163160733, 0.30561359333158505),
];

/// Bound on the rounding error of a million steps, relative to the final state, in the norm
/// `‖(q, v)‖² = ω²q² + v²`.
///
/// The computed step is `x' = M x + δ`. Each coordinate is `x + Δx`, where the sum is rounded
/// (twice in velocity Verlet, which kicks twice) and `|Δx| ≤ z‖x‖` comes from at most ten rounded
/// operations, so to first order `‖δ‖ ≤ √2 (2 + 10 z) u ‖x‖` with `z = ωΔt`. The errors add up to
/// `Σ Mⁿ⁻ᵏ δₖ`. There is a norm in which `M` stretches every vector by its spectral radius `ρ`,
/// the energy's for Euler and RK4, the modified energy's for the symplectic methods; it differs
/// from the energy's by a condition number `κ² ≤ (1 + z/2)/(1 − z/2)`. Hence
/// `‖eₙ‖ ≤ κ Σ ρⁿ⁻ᵏ‖δₖ‖`, and with `‖xₖ‖ ≤ κ ρᵏ⁻ⁿ‖xₙ‖` it is `κ² n √2 (2 + 10 z) u ‖xₙ‖` at most.
fn bound(z: f64) -> f64 {
    let u = f64::EPSILON / 2.0;
    let kappa2 = (1.0 + z / 2.0) / (1.0 - z / 2.0);
    kappa2 * STEPS as f64 * 2.0_f64.sqrt() * (2.0 + 10.0 * z) * u
}

#[test]
fn a_million_steps_stay_within_the_rounding_bound() {
    for (omega2, dt, method, q, v) in ORBITS {
        let system = AnySystem::build("oscillator", &[("omega2", omega2)]).unwrap();
        let float = FloatType::F64;
        let start = [vec![1.0], vec![0.0]];
        let every = STEPS;
        let steps = STEPS;
        let request = Request {
            system: from(system, start),
            stepping: method.into(),
            float,
            dt,
            steps,
            every,
            ensemble: None,
            timing: Default::default(),
            record: None,
            seed: 0,
        };
        let table = simulate(&request).unwrap().table;
        let last = |name| match table.column(name) {
            Some(Values::F64(x)) => x[x.len() - 1],
            other => panic!("{other:?}"),
        };
        let norm = |q: f64, v: f64| (omega2.sqrt() * q).hypot(v);
        let error = norm(last("q") - q, last("q'") - v) / norm(q, v);
        let bound = bound(omega2.sqrt() * dt);
        let name = method.name();
        println!("{omega2:4} {dt:5} {name:28} error {error:8.1e}  bound {bound:8.1e}");
        assert!(error <= bound, "{name} at {dt}: {error:e} > {bound:e}");
    }
}
