//! Verdicts on motions that samples do not show.

use libration_analyze::motion::narrow_force;
use libration_report::verdict::Outcome;

use super::verdicts::{examined, force, plane};

#[test]
fn a_force_between_the_evaluations_of_a_motion_is_found() {
    // A bell of height 1e6 and width w holds the energy 1e6·w·√π, more than the 0.5·(1 − c²) of the motion at its centre c: the motion
    // turns within four widths of it, so that the range of `q0` is 1 − c.
    for (bell, width) in [
        ("exp(-((q0-0.512345)/1e-5)^2)", 1e-5),
        ("if(abs(q0-0.512345)<1e-6, 1, 0)", 1e-6),
        ("(1-tanh((q0-0.512345)/1e-6)^2)", 1e-6),
        ("max(0, 1-abs(q0-0.512345)/1e-6)", 1e-6),
    ] {
        let found = examined(&force(&format!("-q0 + 1e6*{bell}")), "rk4", 0.05, 60);
        let motion = &found.motion.as_ref().unwrap().examination.verdict;
        // Forces that jump by so much end the reference.
        let may_be_unknown = bell.contains("if") || bell.contains("max");
        if may_be_unknown && motion.outcome == Outcome::Unknown {
            continue;
        }
        assert_eq!(motion.outcome, Outcome::NotResolved, "{bell}");
        let range = found.motion.as_ref().unwrap().examination.states[0].range;
        let off = (range - (1.0 - 0.512345)).abs();
        // Of a bell the tail with the energy of the motion is within four widths.
        assert!(off < 4.0 * width + 1e-9, "{bell}: {range}");
    }
    // A pulse of time: 1e4·1e-5·√π = 0.177 of velocity.
    for pulse in ["1e4*exp(-((t-2.312345)/1e-5)^2)", "1e4/(1+((t-2.312345)/1e-5)^2)"] {
        let found = examined(&force(&format!("-q0 + {pulse}")), "rk4", 0.05, 60);
        assert_eq!(
            found.motion.as_ref().unwrap().examination.verdict.outcome,
            Outcome::NotResolved,
            "{pulse}"
        );
    }
    // Smooth forces, friction and a stiff wall have none.
    for (smooth, dt) in [
        ("-sin(q0) - 0.1*q0'", 0.05),
        ("-q0 - 0.3*tanh(q0'/1e-2)", 0.001),
        ("-9.81 + if(q0 < 0, -1e5*q0, 0)", 1e-4),
    ] {
        let found = examined(&force(smooth), "rk4", dt, 1000);
        assert_eq!(
            found.motion.as_ref().unwrap().examination.verdict.outcome,
            Outcome::Resolved,
            "{smooth}"
        );
    }
}

#[test]
fn a_search_of_steps_knows_of_narrow_forces() {
    let missed = |text: &str| {
        let system = force(text);
        let never = std::sync::atomic::AtomicBool::new(false);
        narrow_force(system.equations.dynamics(), &system.start(), 3.0, &never).unwrap()
    };
    // From 1 at rest q0 = cos t: the centre is reached after 1.0329 s.
    let time = missed("-q0 + 1e6*exp(-((q0-0.512345)/1e-5)^2)").unwrap();
    assert!((1.0329..1.0329 + 2.0 * 3.0 / 64.0).contains(&time), "{time}");
    assert_eq!(missed("-sin(q0)"), None);
    assert_eq!(missed("-q0 - 0.1*tanh(q0')"), None);
}

#[test]
fn steps_that_were_not_compared_are_not_known() {
    let found = examined(&force("-q0"), "rk4", 1e-3, 100_000_000);
    let examination = &found.motion.as_ref().unwrap().examination;
    assert!(examination.examined_steps < examination.requested_steps);
    assert_eq!(found.motion.as_ref().unwrap().examination.verdict.outcome, Outcome::Unknown);
}

#[test]
fn a_step_that_adds_nothing_to_a_resonant_chain_is_not_unstable() {
    // The exact motion of y grows as t does: deviations of a step of |z| < 2 do as well.
    for (method, dt) in [("velocity-verlet", 0.01), ("symplectic-euler", 1.9), ("leapfrog", 0.5)] {
        let found = examined(&plane(["-x", "-y+x"], "x = 1.0", ""), method, dt, 100);
        let step = &found.verdicts.step;
        let is_unstable = step.as_ref().is_some_and(|own| own.outcome == Outcome::Unstable);
        assert!(!is_unstable, "{method} {dt}: {step:?}");
    }
}

#[test]
fn an_equilibrium_that_a_motion_stays_away_from_does_not_decide() {
    // At the origin the frequency is 1e4.5 rad/s; the orbit has radius 1.
    let orbit = ["-x/(x^2+y^2+1e-6)^1.5", "-y/(x^2+y^2+1e-6)^1.5"];
    let orbit = plane(orbit, "x = 1.0, \"y'\" = 1.0", "");
    let found = examined(&orbit, "velocity-verlet", 0.001, 7000);
    assert_eq!(found.verdicts.step, None);
    assert_eq!(found.motion.as_ref().unwrap().examination.verdict.outcome, Outcome::Resolved);
}

#[test]
fn a_sine_of_an_angle_beyond_its_range_is_no_divergence() {
    let fast = plane(["-sin(x)", "0"], "x = 1.0, \"x'\" = 1e8", "");
    let found = examined(&fast, "rk4", 0.01, 100);
    let motion = &found.motion.as_ref().unwrap().examination.verdict;
    assert_eq!(motion.outcome, Outcome::Unknown);
    assert!(motion.evidence.contains("`sin` has no value at"), "{motion}");
}
