//! Tests of modes and stable steps of systems by equations at their operating points, and along their motion.

use libration::{AnyMethod, ImplicitMethod, Method};
use libration_analyze::linear_analysis::StepAnalysis;
use libration_analyze::{Analysis, Criteria, Request, Timing, analyze};
use libration_report::verdict::Outcome;
use libration_settings::equations::EquationSystem;

/// The analysis of `steps` steps of `dt` seconds on the equations of a file.
fn analysis(equations: &str, method: impl Into<AnyMethod>, dt: f64, steps: u64) -> Analysis {
    let text = format!("[system]\nname = \"own\"\n{equations}\n");
    let system = EquationSystem::parse(&text, "own.toml", &[]).unwrap();
    let (stepping, criteria, timing) =
        (method.into().into(), Criteria::default(), Timing::default());
    analyze(&Request { system, stepping, dt, steps, criteria, timing }).unwrap()
}

/// The growth of the fastest mode in 1/s.
fn growth(found: &Analysis) -> f64 {
    found.linear().unwrap().modes[0].growth_rate
}

fn outcome(found: &Analysis) -> Outcome {
    found.linear().unwrap().verdicts.plant.outcome
}

fn step<'a>(found: &'a Analysis, method: &str) -> &'a StepAnalysis {
    let linear = found.linear().unwrap();
    linear.steps.iter().find(|step| step.integrator == method).unwrap()
}

/// Where RK4 loses stability on the negative real axis and on the imaginary axis.
const REAL: f64 = 2.785_293_563_405_282;
const IMAGINARY: f64 = 2.828_427_124_746_19;

const BODY: &str = "rate.a = \"-b*c\"\nrate.b = \"a*c\"\nrate.c = \"-a*b/3\"\n\
                    start = { a = 0.01, b = 1, c = 0.01 }";
const PAIR: &str = "rate.a = \"-1000*a*b\"\nrate.b = \"1000*a*b\"\nstart = { a = 1, b = 0.001 }";

#[test]
fn a_rotation_about_the_middle_axis_grows_at_its_rate_by_euler() {
    let found = analysis(BODY, Method::Rk4, 0.01, 100);
    let point = found.operating_point().unwrap();
    let b = point.states[1].value;
    // By hand: b √((I₂ − I₁)(I₃ − I₂)/(I₁I₃)) with moments 1, 2 and 3.
    assert!((growth(&found) - b / 3.0_f64.sqrt()).abs() < 1e-12, "{point:?}");
    assert!((b - 1.0).abs() < 1e-3 && point.distance < 0.015, "{point:?}");
    assert_eq!((point.continuum, point.undecided, outcome(&found)), (1, 0, Outcome::Unstable));
    assert!(point.sentence().contains("Equilibria form a continuum of 1 dimension there"));
}

#[test]
fn growth_and_decay_at_rounding_level_are_none_and_a_linearisation_of_zero_decides_nothing() {
    for (equations, method) in [
        ("rate.x = \"-x^3\"\nstart = { x = 1 }", Method::Rk4),
        ("rate.x = \"x^2\"\nstart = { x = -1 }", Method::ExplicitEuler),
        ("rate.x = \"-(x - 1)^3\"\nstart = { x = 4 }", Method::Rk4),
        ("coordinates = [\"x\"]\nacceleration.x = \"-x^3\"\nstart = { x = 1 }", Method::Leapfrog),
        (
            "rate.x = \"-x*(x^2 + y^2)\"\nrate.y = \"-y*(x^2 + y^2)\"\nstart = { x = 1, y = 2 }",
            Method::Rk4,
        ),
    ] {
        let found = analysis(equations, method, 0.01, 50);
        let linear = found.linear().unwrap();
        assert_eq!(outcome(&found), Outcome::Unknown, "{equations}");
        assert!(linear.modes.iter().all(|mode| mode.eigenvalue == [0.0, 0.0]), "{linear:?}");
        let own = step(&found, method.name());
        assert_eq!((&own.stable_dt, own.largest_stable_dt), (&None, None));
        assert!(own.unknown_stable_dt.unwrap().contains("decides nothing"));
    }
    // A free mass is linear: any step is stable.
    let free = "coordinates = [\"x\"]\nacceleration.x = \"0*x\"\nstart = { x = 1 }";
    let found = analysis(free, Method::Leapfrog, 0.01, 50);
    assert_eq!(step(&found, "leapfrog").stable_dt, Some(vec![[Some(0.0), None]]));
    // A direction without a linearisation beside friction of 0.1/s.
    let friction = "coordinates = [\"x\"]\nacceleration.x = \"-x^3 - 0.1*x'\"\nstart = { x = 0.5 }";
    let found = analysis(friction, Method::Rk4, 0.01, 50);
    assert_eq!((outcome(&found), growth(&found)), (Outcome::Unknown, 0.0));
    assert_eq!(found.linear().unwrap().verdicts.plant.not_examined.len(), 1);
    assert_eq!(found.operating_point().unwrap().undecided, 1);
}

#[test]
fn conserved_sums_of_the_start_hold_at_the_operating_point() {
    let found = analysis(PAIR, Method::Rk4, 0.001, 100);
    let point = found.operating_point().unwrap();
    assert_eq!(point.conserved[0].sum, "a + b");
    assert!(point.conserved[0].equal && point.continuum == 1, "{point:?}");
    assert!((growth(&found) - 1001.0).abs() < 1e-6);
    let epidemic = "rate.s = \"-0.5*s*i\"\nrate.i = \"0.5*s*i - 0.1*i\"\nrate.r = \"0.1*i\"\n\
                    start = { s = 0.99, i = 0.01, r = 0 }";
    let found = analysis(epidemic, Method::Rk4, 0.01, 100);
    let point = found.operating_point().unwrap();
    let [s, i, r] = [0, 1, 2].map(|k| point.states[k].value);
    assert!(i == 0.0 && (s + r - 1.0).abs() < 1e-9 && point.continuum == 2, "{point:?}");
    assert!((growth(&found) - (0.5 * s - 0.1)).abs() < 1e-12);
    // A mass that moves freely has no equilibrium with its momentum, so the point is out of its reach.
    let moving = "coordinates = [\"x\"]\nacceleration.x = \"0*x\"\nstart = { x = 1, \"x'\" = 2 }";
    let found = analysis(moving, Method::Leapfrog, 0.01, 50);
    let sentence = found.operating_point().unwrap().sentence();
    assert!(sentence.contains("it conserves x', which is 2 at the start and 0 here"), "{sentence}");
}

#[test]
fn stable_steps_along_the_motion_are_those_of_its_fastest_part() {
    let oscillator = "coordinates = [\"x\"]\nacceleration.x = \"-100*x\"\nstart = { x = 1 }";
    for (equations, method, horizon, wanted, tolerance) in [
        // It ends at (0, 1.001) with a rate of 1001.
        (PAIR, Method::Rk4, 0.1, REAL / 1001.0, 1e-6),
        (oscillator, Method::Rk4, 1.0, IMAGINARY / 10.0, 1e-12),
        (oscillator, Method::VelocityVerlet, 1.0, 0.2, 1e-12),
        (oscillator, Method::ExplicitEuler, 1.0, 0.0, 1e-12),
        // 3x² is most at the start.
        ("rate.x = \"-x^3\"\nstart = { x = 10 }", Method::Rk4, 1.0, REAL / 300.0, 1e-12),
        // A logistic growth, whose rate is 1 − 2x.
        ("rate.x = \"x*(1 - x)\"\nstart = { x = 0.01 }", Method::ExplicitEuler, 40.0, 2.0, 1e-6),
        // A pendulum is stiffest when it hangs, near one of 64 states.
        (
            "coordinates = [\"q\"]\nacceleration.q = \"-9.81*sin(q)\"\nstart = { q = 2 }",
            Method::VelocityVerlet,
            10.0,
            2.0 / 9.81_f64.sqrt(),
            0.05,
        ),
    ] {
        let found = analysis(equations, method, horizon / 50.0, 50);
        let steps = found.steps_along_motion.unwrap();
        assert!(steps.until == horizon && steps.unknown_states == 0, "{steps:?}");
        let dt = steps.largest_stable_dt.unwrap();
        assert!((dt - wanted).abs() <= tolerance * wanted, "{equations} {method:?} {steps:?}");
    }
    // Implicit steps have no limit.
    let found = analysis(PAIR, ImplicitMethod::BackwardEuler, 0.001, 100);
    assert_eq!(found.steps_along_motion.as_ref().unwrap().largest_stable_dt, None);
}

#[test]
fn gyroscopic_plants_have_no_growth_of_their_own_and_known_steps() {
    let turning = |w2: f64, rotation: f64| {
        format!(
            "coordinates = [\"x\", \"y\"]\nacceleration.x = \"-{w2}*x + 2*{rotation}*y'\"\n\
             acceleration.y = \"-{w2}*y - 2*{rotation}*x'\"\nstart = {{ x = 1 }}"
        )
    };
    // A charge in a field, and masses at the fourth point of Lagrange.
    let charge = "coordinates = [\"x\", \"y\"]\nacceleration.x = \"5*y'\"\nacceleration.y = \"-5*x'\"\nstart = { x = 1 }";
    let lagrange = "coordinates = [\"x\", \"y\"]\nparameters = { m = 0.01 }\n\
        acceleration.x = \"2*y' + x - (1-m)*(x+m)/((x+m)^2+y^2)^1.5 - m*(x-1+m)/((x-1+m)^2+y^2)^1.5\"\n\
        acceleration.y = \"-2*x' + y - (1-m)*y/((x+m)^2+y^2)^1.5 - m*y/((x-1+m)^2+y^2)^1.5\"\n\
        start = { x = 0.48, y = 0.86 }";
    let (strong, weak) = (turning(10.0, 0.5), turning(0.9, 5e-5));
    for equations in [strong.as_str(), weak.as_str(), charge, lagrange] {
        for method in [Method::SymplecticEuler, Method::VelocityVerlet, Method::TextbookVerlet] {
            let found = analysis(equations, method, 0.01, 10);
            assert_eq!(growth(&found), 0.0, "{equations}");
            let own = step(&found, method.name());
            // NumPy: the radius exceeds 1 at each step, by 5.35e-5 of the first in velocity Verlet steps.
            assert_eq!(own.stable_dt, Some(vec![]), "{equations} {method:?}");
            assert_eq!(own.unknown_stable_dt, None);
        }
        let found = analysis(equations, ImplicitMethod::ImplicitMidpoint, 0.01, 10);
        assert_eq!(step(&found, "implicit-midpoint").stable_dt, Some(vec![[Some(0.0), None]]));
    }
    let verlet = analysis(&strong, Method::VelocityVerlet, 0.01, 10);
    let radius = step(&verlet, "velocity-verlet").spectral_radius.unwrap();
    assert!((radius - 1.0 - 5.350_134_479e-5).abs() < 1e-13, "{radius}");
}

#[test]
fn modes_are_those_of_the_jacobian_by_hand_at_well_known_equilibria() {
    for (equations, wanted, distance) in [
        // A pendulum upright, a particle on the barrier of a double well, and predators with their prey.
        (
            "coordinates = [\"q\"]\nacceleration.q = \"-9*sin(q)\"\nstart = { q = 3.1 }",
            3.0,
            core::f64::consts::PI - 3.1,
        ),
        ("coordinates = [\"x\"]\nacceleration.x = \"x - x^3\"\nstart = { x = 0.01 }", 1.0, 0.01),
        ("rate.x = \"x - x*y\"\nrate.y = \"x*y - y\"\nstart = { x = 2, y = 1 }", 0.0, 1.0),
        // A mass on a spring of length 1 that hangs: it swings at √(g/1.1) and √(k/m), with m g = 0.1 k.
        (
            "coordinates = [\"x\", \"y\"]\nacceleration.x = \"-98.1*x*(1 - 1/sqrt(x^2 + y^2))\"\n\
             acceleration.y = \"-98.1*y*(1 - 1/sqrt(x^2 + y^2)) - 9.81\"\nstart = { x = 0.1, y = -1 }",
            0.0,
            0.02_f64.sqrt(),
        ),
    ] {
        let found = analysis(equations, Method::Rk4, 0.01, 20);
        assert!((growth(&found) - wanted).abs() < 1e-9, "{equations} {}", growth(&found));
        let point = found.operating_point().unwrap();
        assert!((point.distance - distance).abs() < 1e-9, "{point:?}");
        assert_eq!((point.continuum, point.undecided), (0, 0));
    }
}
