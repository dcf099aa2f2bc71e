//! Tests of the causes of overflows.

use libration::{AnySystem, Method};
use libration_analyze::Stepping;
use libration_analyze::trajectory::{EnsembleOptions, FloatType, Outcome, Request, simulate};
use libration_settings::equations::EquationSystem;

use super::trajectory::{at, from};

/// The report's oscillator, or another system with these parameters.
fn request(system: &str, parameters: &[(&str, f64)], method: Method, dt: f64) -> Request {
    Request {
        system: from(AnySystem::build(system, parameters).unwrap(), [vec![1.0], vec![0.0]]),
        stepping: method.into(),
        float: FloatType::F64,
        dt,
        steps: 30_000,
        every: 30_000,
        ensemble: None,
        timing: Default::default(),
        record: None,
        seed: 0,
    }
}

/// The reason that the trajectory ends; none if it does not.
fn reason(request: &Request) -> Option<String> {
    match simulate(request).unwrap().outcome {
        // Just below their limit symplectic steps keep the state finite, and no energy.
        Outcome::Complete | Outcome::Iterated(_) | Outcome::EnergyDiverges { .. } => None,
        Outcome::Diverged(stopped) => Some(stopped.reason),
        Outcome::NotFinite { reason, .. } => Some(reason.unwrap_or_default()),
    }
}

#[test]
fn the_limit_of_a_method_on_an_oscillator_is_named_with_the_step_that_it_allows() {
    let of = |method, dt| request("oscillator", &[("omega2", 10.0)], method, dt);
    // ω = √10, so that the limits 2, 2√2 and 1.5734 of ωΔt are at Δt = 0.63245, 0.89442 and 0.49755.
    for (method, dt, said, below) in [
        (Method::VelocityVerlet, 0.7, "ωΔt = 2.21 exceeds velocity-verlet's limit 2", 0.632),
        (Method::SymplecticEuler, 1.0, "ωΔt = 3.16 exceeds symplectic-euler's limit 2", 0.632),
        (Method::Rk4, 0.9, "ωΔt = 2.85 exceeds rk4's limit 2.83", 0.894),
        (Method::Yoshida4, 0.51, "ωΔt = 1.61 exceeds yoshida4's limit 1.57", 0.497),
    ] {
        let found = reason(&of(method, dt)).unwrap();
        let wanted = format!("the state stopped being finite: {said}; choose --dt below {below}");
        assert_eq!(found, wanted);
        assert_eq!(reason(&of(method, below)), None, "{method:?}");
    }
}

#[test]
fn a_damped_step_has_a_limit_of_its_own() {
    // |λ|² = 1 − γΔt + ω²Δt² is above one beyond Δt = γ/ω².
    let parameters = [("omega2", 10.0), ("gamma", 1.0)];
    let of = |dt| request("damped-oscillator", &parameters, Method::ExplicitEuler, dt);
    let found = reason(&of(0.2)).unwrap();
    let wanted = "Δt = 0.2 s exceeds explicit-euler's limit 0.1 s; choose --dt below 0.1";
    assert!(found.ends_with(wanted), "{found}");
    assert_eq!(reason(&of(0.0999)), None);
}

#[test]
fn no_step_is_recommended_where_none_is_stable() {
    let found = reason(&request("oscillator", &[], Method::ExplicitEuler, 0.1)).unwrap();
    assert!(found.contains("explicit-euler is unstable with every time step"), "{found}");
    assert!(found.contains("a smaller --dt only delays the overflow"), "{found}");
}

#[test]
fn a_stable_step_that_overflows_names_the_float_type() {
    // ω²q = 3·10⁵ is no number of f16.
    let of = |stepping: Stepping, float| Request {
        float,
        stepping,
        ..at(3e4, request("oscillator", &[("omega2", 10.0)], Method::Rk4, 0.1))
    };
    let verlet = Stepping::Method(Method::VelocityVerlet);
    let found = reason(&of(verlet, FloatType::F16)).unwrap();
    let wanted = "the step is stable, but a number exceeds the range of f16, 65504; choose a wider";
    assert!(found.contains(wanted), "{found}");
    assert_eq!(reason(&of(verlet, FloatType::F32)), None);
    let large = at(1e308, of(verlet, FloatType::F64));
    let found = reason(&large).unwrap();
    assert!(found.contains("range of f64, 1.798e308; choose a start nearer"), "{found}");
}

#[test]
fn a_nonlinear_system_is_judged_by_its_linearisation_at_the_start_or_not_at_all() {
    // α + 3βq² = 30001 at q = 10.
    let parameters = [("alpha", 1.0), ("beta", 100.0)];
    let stiff = request("duffing", &parameters, Method::Leapfrog, 0.1);
    let found = reason(&at(10.0, stiff)).unwrap();
    let wanted =
        "linearised at the start, ωΔt = 17.3 exceeds leapfrog's limit 2; choose --dt below 0.0115";
    assert!(found.ends_with(wanted), "{found}");
    // Beyond its energy of escape the exact solution leaves for infinity as well.
    let (q, v) = (vec![0.0, 2.0], vec![0.0, 1.0]);
    let one = AnySystem::build("henon-heiles", &[] as &[(&str, f64)]).unwrap();
    let oscillator = request("oscillator", &[], Method::Leapfrog, 0.01);
    let escape = Request { system: from(one, [q, v]), ..oscillator };
    assert_eq!(reason(&escape).unwrap(), "the state stopped being finite");
}

#[test]
fn a_system_by_equations_has_the_reasons_of_the_same_system_by_name() {
    let own = |acceleration: &str, x: f64| {
        let text = format!(
            "[system]\nname = \"own\"\ncoordinates = [\"x\"]\nacceleration.x = \"{acceleration}\"\nstart = {{ x = {x:?} }}"
        );
        EquationSystem::parse(&text, "own", &[]).unwrap()
    };
    let of = |name, method, dt| request(name, &[("omega2", 10.0)], method, dt);
    let half = Request { float: FloatType::F16, ..of("oscillator", Method::Rk4, 0.1) };
    for (named, system) in [
        (of("oscillator", Method::Rk4, 0.9), own("-10*x", 1.0)),
        (of("damped-oscillator", Method::ExplicitEuler, 0.5), own("-10*x - 0.2*x'", 1.0)),
        // ω² = 10 cos(0.5) = 8.78.
        (at(0.5, of("pendulum", Method::SymplecticEuler, 0.7)), own("-10*sin(x)", 0.5)),
        (at(3e4, half), own("-10*x", 3e4)),
    ] {
        let found = reason(&named);
        assert!(found.is_some(), "{named:?}");
        assert_eq!(reason(&Request { system, ..named }), found);
    }
}

#[test]
fn several_trajectories_have_the_reason_of_one() {
    let ensemble = Some(EnsembleOptions { count: 3, spread: 0.1, threads: 1, instructions: None });
    let of = |dt| request("oscillator", &[("omega2", 10.0)], Method::VelocityVerlet, dt);
    let found = reason(&Request { ensemble, ..of(0.7) }).unwrap();
    assert_eq!(found, "ωΔt = 2.21 exceeds velocity-verlet's limit 2; choose --dt below 0.632");
}

#[test]
fn beyond_several_windows_that_of_small_steps_is_recommended() {
    // Of Suzuki's method on ω² = 100, γ = 3 windows are 0 to 0.40367 and a sliver at 0.791, as NumPy finds them.
    let parameters = [("omega2", 100.0), ("gamma", 3.0)];
    let of = |dt| request("damped-oscillator", &parameters, Method::Suzuki4, dt);
    let found = reason(&of(0.9)).unwrap();
    assert!(found.ends_with("exceeds suzuki4's limit 0.404 s; choose --dt below 0.403"), "{found}");
    assert_eq!(reason(&of(0.403)), None);
}

#[test]
fn a_free_mass_that_leaves_the_float_type_is_not_called_unstable() {
    let undamped = [("omega2", 0.0), ("gamma", 0.0)];
    for (system, parameters) in [("oscillator", &undamped[..1]), ("damped-oscillator", &undamped)] {
        let free = request(system, parameters, Method::Rk4, 10.0);
        let one = AnySystem::build(system, parameters).unwrap();
        let moving = from(one, [vec![1.0], vec![100.0]]);
        let found = reason(&Request { system: moving, float: FloatType::F16, ..free }).unwrap();
        assert!(found.contains("the step is stable, but a number exceeds"), "{found}");
    }
}

#[test]
fn recorded_steps_beyond_the_limit_of_the_method_are_named_with_their_mean() {
    // Steps seven times as long as dt = 0.1: ωΔt = 0.7·√10 = 2.21, and 2/(7·√10) = 0.09035 s is the largest dt.
    let even = request("oscillator", &[("omega2", 10.0)], Method::VelocityVerlet, 0.1);
    let slow = Request { record: Some(vec![7.0; 3000]), steps: 3000, every: 3000, ..even };
    let found = reason(&slow).unwrap();
    let wanted = "at the mean recorded step, ωΔt = 2.21 exceeds velocity-verlet's limit 2; choose --dt below 0.0903";
    assert!(found.ends_with(wanted), "{found}");
}
