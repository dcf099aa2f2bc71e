//! Verdicts on steps and motions, against closed forms and SciPy.

use libration::AnyMethod;
use libration_analyze::{Analysis, Criteria, Request, Timing, analyze};
use libration_report::verdict::{Outcome, exit_code};
use libration_settings::equations::EquationSystem;

use super::read;

/// A system by the lines of its table.
pub(crate) fn system(lines: &str) -> EquationSystem {
    let text = format!("[system]\nname = \"case\"\n{lines}");
    EquationSystem::parse(&text, "case", &[]).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn examined(system: &EquationSystem, method: &str, dt: f64, steps: u64) -> Analysis {
    let method = AnyMethod::from_name(method).unwrap();
    let (system, stepping) = (system.clone(), method.into());
    let (criteria, timing) = (Criteria::default(), Timing::default());
    analyze(&Request { system, stepping, dt, steps, criteria, timing }).unwrap()
}

/// One coordinate `q0` from 1 at rest.
pub(crate) fn force(acceleration: &str) -> EquationSystem {
    system(&format!(
        "coordinates = [\"q0\"]\nacceleration.q0 = \"{acceleration}\"\nstart = {{ q0 = 1.0 }}\n"
    ))
}

/// One state `x` of first order.
fn rate(rate: &str, start: f64) -> EquationSystem {
    system(&format!("rate.x = \"{rate}\"\nstart = {{ x = {start:?} }}\n"))
}

/// A system in the plane, with `more` lines of its table.
pub(crate) fn plane(accelerations: [&str; 2], start: &str, more: &str) -> EquationSystem {
    let [x, y] = accelerations;
    system(&format!(
        "coordinates = [\"x\", \"y\"]\nacceleration.x = \"{x}\"\nacceleration.y = \"{y}\"\nstart = {{ {start} }}\n{more}"
    ))
}

#[test]
fn a_step_that_is_unstable_says_so_whatever_three_halved_steps_agree_on() {
    // The spectral radius: of a trace t and determinant 1 (t + √(t² − 4))/2; of Runge-Kutta |R(λh)|; of determinant d with complex
    // eigenvalues √d.
    let of_trace = |trace: f64| 0.5 * (trace.abs() + (trace * trace - 4.0).sqrt());
    let z: f64 = 2.05;
    let symplectic_euler = {
        // Kick and drift: [[1 − h², h(1 − 10h)], [−h, 1 − 10h]].
        let (h, d) = (0.21_f64, 1.0 - 10.0 * 0.21);
        let trace = 1.0 - h * h + d;
        0.5 * (trace.abs() + (trace * trace - 4.0 * d).sqrt())
    };
    for (system, method, dt, radius) in [
        (force("-q0"), "velocity-verlet", z, of_trace(2.0 - z * z)),
        (force("-q0"), "rk4", 3.0, 0.125_f64.hypot(1.5)),
        (force("-q0"), "explicit-euler", 0.5, 1.25_f64.sqrt()),
        (force("-q0-10*q0'"), "symplectic-euler", 0.21, symplectic_euler),
        (rate("-1000*x", 1.0), "rk4", 0.003, 1.0 - 3.0 + 4.5 - 4.5 + 3.375),
        // Siblings: a decay, an offset, a start at rest, a step that grows slowly, and one that no run shows.
        (rate("-50*x", 1.0), "explicit-euler", 0.041, 50.0 * 0.041 - 1.0),
        (rate("3-x", 0.0), "explicit-euler", 2.5, 1.5),
        (force("-4*(q0-1)"), "leapfrog", 1.1, of_trace(2.0 - 4.84)),
        (force("-q0"), "explicit-euler", 1e-3, (1.0 + 1e-6_f64).sqrt()),
        (force("-sin(q0)"), "explicit-euler", 1e-3, (1.0 + 1e-6_f64).sqrt()),
    ] {
        let found = examined(&system, method, dt, 3000);
        let step = found.verdicts.step.as_ref().unwrap();
        assert_eq!(step.outcome, Outcome::Unstable, "{method} {dt}: {step}");
        let own = found.motion.as_ref().unwrap().spectral_radius.unwrap();
        // Eigenvalues of matrices of two rows.
        assert!((own - radius).abs() < 1e-12 * radius, "{method} {dt}: {own} {radius}");
        assert_eq!(exit_code(found.verdicts.all()), 1);
    }
}

#[test]
fn a_step_that_lets_only_the_system_grow_is_stable() {
    for (system, method, dt) in [
        (force("q0"), "rk4", 0.1),
        (rate("0.5*x", 1.0), "explicit-euler", 0.1),
        (force("-q0"), "velocity-verlet", 1.99),
        (force("-q0-0.2*q0'"), "rk4", 0.1),
        (rate("-1000*x", 1.0), "backward-euler", 1.0),
        (system("rate.x = \"1\"\n"), "rk4", 0.1),
    ] {
        let found = examined(&system, method, dt, 20);
        let step = found.verdicts.step.as_ref().unwrap();
        assert_eq!(step.outcome, Outcome::Stable, "{method} {dt}: {step}");
    }
}

/// A pendulum of Foucault, whose swing turns: `x'' = −x + 0.02 y'`, `y'' = −y − 0.02 x'`.
fn foucault() -> EquationSystem {
    let energy = "energy = \"(x'^2 + y'^2 + x^2 + y^2)/2\"\n";
    plane(["-x + 0.02*y'", "-y - 0.02*x'"], "x = 1.0", energy)
}

/// The oscillator of van der Pol.
fn van_der_pol(mu: f64) -> EquationSystem {
    system(&format!(
        "coordinates = [\"x\"]\nacceleration.x = \"{mu}*(1-x^2)*x' - x\"\nstart = {{ x = 2.0 }}\n"
    ))
}

#[test]
fn a_motion_with_errors_as_large_as_itself_is_not_resolved_over_all_steps() {
    let ball = "coordinates = [\"y\"]\nacceleration.y = \"if(y < 0, -1e6*y, 0) - 9.81\"\nstart = { y = 1.0 }\n";
    for (system, method, dt, steps) in [
        // SciPy: x(30) = 1; the run ends at another point.
        (rate("x*(1-x)", 0.01), "rk4", 3.0, 1000),
        (van_der_pol(5.0), "explicit-euler", 0.05, 1000),
        (system(ball), "velocity-verlet", 0.01, 1000),
        // Siblings: phases drift by z³/24 a step; a pericentre; a motion that decays at once; a double well; a beat.
        (force("-sin(q0)"), "velocity-verlet", 0.3, 5000),
        (
            plane(["-x/(x^2+y^2)^1.5", "-y/(x^2+y^2)^1.5"], "x = 0.1, \"y'\" = 4.36", ""),
            "rk4",
            0.05,
            200,
        ),
        (rate("-20*x^3", 1.0), "backward-euler", 0.5, 1000),
        (force("q0-2*q0^3"), "symplectic-euler", 0.5, 2000),
        (plane(["-x+0.1*y", "-y+0.1*x"], "x = 1.0", ""), "leapfrog", 0.4, 2000),
    ] {
        let found = examined(&system, method, dt, steps);
        let motion = &found.motion.as_ref().unwrap().examination.verdict;
        assert_eq!(motion.outcome, Outcome::NotResolved, "{method} {dt}: {motion}");
        assert_eq!(exit_code(found.verdicts.all()), 1);
    }
}

#[test]
fn an_energy_that_grows_beyond_all_bounds_belongs_to_no_resolved_motion() {
    // A kick takes the velocity from before it, so that gyroscopic forces add energy at each step.
    let found = examined(&foucault(), "velocity-verlet", 0.3, 20_000);
    let energy = found.motion.as_ref().unwrap().energy.as_ref().unwrap();
    // The exact motion conserves ½, of which all is exchanged.
    assert!((energy.scale.unwrap() - 0.5).abs() < 0.01, "{energy:?}");
    assert!(energy.exact_change.unwrap() < 1e-9, "{energy:?}");
    assert!(energy.error.unwrap() > 0.5, "{energy:?}");
    assert_eq!(exit_code(found.verdicts.all()), 1);
}

#[test]
fn small_errors_are_resolved_whatever_ratio_they_have() {
    for (system, method, dt, steps) in [
        // An error of one state passes zero; a constant state; a large offset; a state at rest; a motion that has decayed.
        (force("-sin(q0)"), "dormand-prince-5", 0.1, 1000),
        (plane(["-x", "0"], "x = 1.0", ""), "rk4", 0.02, 1000),
        (force("-(q0-1e6)*4"), "rk4", 0.01, 500),
        (plane(["-x", "-y"], "x = 1.0", ""), "yoshida4", 0.02, 1000),
        (force("-q0 - 2*q0'"), "rk4", 0.05, 5000),
        (rate("x*(1-x)", 0.01), "rk4", 0.1, 1000),
        (van_der_pol(5.0), "rk4", 0.002, 5000),
    ] {
        let found = examined(&system, method, dt, steps);
        assert_eq!(
            found.motion.as_ref().unwrap().examination.verdict.outcome,
            Outcome::Resolved,
            "{method}: {}",
            found.motion.as_ref().unwrap().examination.verdict
        );
        assert_eq!(exit_code(found.verdicts.all()), 0, "{method}: {:?}", found.verdicts);
    }
}

#[test]
fn what_the_reference_cannot_reach_is_unknown_and_no_success() {
    // Of µ = 10⁶ the reference takes 10⁶ steps per second; a chaotic motion loses all digits after some 40 s.
    let lorenz = read("lorenz");
    for (system, method, dt, steps) in [
        (&van_der_pol(1e6), "gauss-legendre-6", 0.01, 100_000),
        (&lorenz, "dormand-prince-8", 0.002, 50_000),
    ] {
        let found = examined(system, method, dt, steps);
        let motion = &found.motion.as_ref().unwrap().examination.verdict;
        assert!(!motion.is_good(), "{method}: {motion}");
        assert_eq!(exit_code(found.verdicts.all()), 1);
    }
    // A motion that ends: x = 1/(1 − t).
    let found = examined(&rate("x^2", 1.0), "backward-euler", 0.1, 20);
    assert!(
        !found.motion.as_ref().unwrap().examination.verdict.is_good(),
        "{}",
        found.motion.as_ref().unwrap().examination.verdict
    );
}

#[test]
fn the_scale_of_the_energy_has_no_arbitrary_constant() {
    let pendulum = |constant: &str| {
        system(&format!(
            "coordinates = [\"q\"]\nacceleration.q = \"-9.81*sin(q)\"\nenergy = \"q'^2/2 - 9.81*cos(q) + {constant}\"\nstart = {{ q = 1.5707963267948966 }}\n"
        ))
    };
    let of = |constant: &str| {
        let found = examined(&pendulum(constant), "velocity-verlet", 0.01, 1000);
        let energy = found.motion.unwrap().energy.unwrap();
        energy.error.unwrap() / energy.scale.unwrap()
    };
    let level = of("0");
    // From level with its pivot the pendulum exchanges g: (ωh)²/8 of the largest kinetic energy, to the next order.
    assert!(level < 9.81 * 1e-4, "{level}");
    // A constant adds its own rounding.
    assert!((of("9.81") / level - 1.0).abs() < 1e-9 && (of("1000") / level - 1.0).abs() < 1e-7);
}

/// A method of ten stages under a friction that differs at each state: exact polynomials take seconds for one of them.
#[test]
fn stable_steps_along_a_damped_motion_are_known_for_steps_of_many_stages() {
    let damped = force("-7.0*q0/(1 + q0^2) - 0.08*q0'*abs(q0')");
    let found = examined(&damped, "blanes-moan-s10-6-kdk", 0.87, 60);
    let along = found.steps_along_motion.unwrap();
    assert!(along.states > 16 && along.unknown_states == 0, "{along:?}");
    // The stiffness is at most 7 s⁻², and the undamped limit of the method more than one stage of Verlet, 2/√7 s.
    let limit = along.largest_stable_dt.unwrap();
    assert!(limit > 2.0 / 7.0_f64.sqrt() && limit < 20.0 / 7.0_f64.sqrt(), "{limit}");
}
