//! `advise --system FILE`, through the binary.

use std::collections::BTreeMap;

use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;

use super::advise::{json, libration};
use super::linear::written;
use super::system_lab::example;

const PENDULUM: &str = "[system]\nname = \"pendulum\"\ncoordinates = [\"q\"]\nparameters = { omega2 = 4.0 }\n\
    acceleration.q = \"-omega2*sin(q)\"\nstart = { q = 1.2 }\n";

/// The numbers of each integrator, by name.
fn steps(advice: &Value) -> BTreeMap<String, [f64; 3]> {
    let all = advice["integrators"].as_array().unwrap();
    let known = |choice: &Value| {
        let name = choice["integrator"].as_str().unwrap().to_owned();
        (name, ["dt", "lost", "evaluations"].map(|key| choice[key].as_f64().unwrap_or(0.0)))
    };
    all.iter().map(known).collect()
}

/// An advice without what differs between two runs, or names the system in command lines.
fn comparable(words: &[&str]) -> Value {
    let mut advice = json(&[&["advise", "-q"], words].concat());
    let object = advice.as_object_mut().unwrap();
    object.retain(|key, _| !matches!(key.as_str(), "command" | "repeat_command"));
    let speed = object["throughput"].as_object_mut().unwrap();
    speed.retain(|key, _| !key.ends_with("a_second"));
    for float in object["floats"].as_array_mut().unwrap() {
        float.as_object_mut().unwrap().remove("command");
    }
    advice
}

#[test]
fn a_catalogue_system_as_equations_gets_the_same_advice_to_the_last_bit() {
    // One with exact steps, one whose time is no state, and one with an energy to keep.
    for (system, tolerance) in [
        ("damped-oscillator", "trajectory"),
        ("driven-oscillator", "trajectory"),
        ("duffing", "energy"),
    ] {
        let words = ["--tolerance", &format!("{tolerance}=1e-3"), "--horizon", "2"];
        let by = |door: &str| comparable(&[&["--system", door], &words[..]].concat());
        let found = by(&format!("tests/doors/{system}.toml"));
        assert_eq!(found, by(system), "{system}");
        assert!(found["integrators"].as_array().unwrap().len() > 8);
    }
}

#[test]
fn a_file_of_equations_begins_where_the_options_say() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(&folder, "pendulum.toml", PENDULUM);
    let start = PENDULUM.replace("q = 1.2", "q = 0.5, \"q'\" = 1.5");
    let wanted = written(&folder, "other.toml", &start);
    let of = |file: &std::path::Path, start: &[&str]| {
        comparable(&[&["--system", file.to_str().unwrap(), "--horizon", "2"], start].concat())
    };
    let wanted = of(&wanted, &[]);
    assert_eq!(of(&file, &["--q", "0.5", "--v", "1.5"]), wanted);
    assert_eq!(of(&file, &["--start", "q=0.5,q'=1.5"]), wanted);
    assert_eq!(wanted["v"][0], 1.5);
}

#[test]
fn the_error_of_states_of_first_order_is_that_of_an_independent_program() {
    let advice = json(&["advise", "-q", "--system", &example("lorenz.toml")]);
    let [first, second, ..] = &advice["integrators"].as_array().unwrap()[..] else {
        panic!("{advice}")
    };
    // Loops of ten lines over NumPy and SciPy's Runge–Kutta step with these steps, against SciPy's DOP853 with tolerances of 1e-13, and with
    // steps 1.2 times as long. The program adds a thousandth for its reference, which is itself off by less than that.
    for (choice, name, dt, lost, beyond) in [
        (first, "dormand-prince-8", 0.048_632_335_929, 9.94716e-4, 5.55075e-3),
        (second, "rk4", 0.007_739_058_043, 9.95256e-4, 3.06370e-3),
    ] {
        assert_eq!(choice["integrator"], name);
        assert!((choice["dt"].as_f64().unwrap() - dt).abs() < 1e-12, "{choice}");
        for (key, wanted) in [("lost", lost), ("lost_beyond", beyond)] {
            let found = choice[key].as_f64().unwrap() / wanted;
            assert!((found - 1.001).abs() < 1e-3, "{name}, {key}: {found}");
        }
    }
}

#[test]
fn the_advised_step_keeps_the_energy_where_forces_depend_on_velocities() {
    let words = ["--tolerance", "energy=1e-4", "--horizon", "0.5"];
    let advice =
        json(&[&["advise", "-q", "--system", &example("cart_pole.toml")], &words[..]].concat());
    // The advised command measures the drift itself.
    let command = advice["command"].as_str().unwrap();
    let analysis = json(&command.split_whitespace().skip(1).collect::<Vec<_>>());
    let energy = |key: &str| analysis["motion"]["energy"][key].as_f64().unwrap();
    let drift = energy("largest") / advice["tolerance"]["scale"].as_f64().unwrap();
    let lost = advice["integrators"][0]["lost"].as_f64().unwrap();
    assert!((drift / lost - 1.0).abs() < 1e-9, "{drift} {lost}");
}

#[test]
fn an_energy_that_is_lost_or_missing_is_no_measure() {
    let damped =
        PENDULUM.replace("sin(q)", "sin(q) - 1e-7*q'") + "energy = \"q'^2/2 - omega2*cos(q)\"\n";
    let folder = tempfile::tempdir().unwrap();
    let file = written(&folder, "damped.toml", &damped);
    let tolerance = ["--tolerance", "energy=1e-6"];
    let advise =
        |file: &str| libration(&[&["advise", "-q", "--system", file], &tolerance[..]].concat());
    advise(file.to_str().unwrap()).code(2).stderr(contains("the system does not conserve it"));
    advise(&example("lorenz.toml")).code(2).stderr(contains("the system has no `energy`"));
}

#[test]
fn what_moves_later_or_has_jumps_gets_its_steps_and_a_warning() {
    let largest = |words: &[&str]| {
        let advice = json(&[&["advise", "-q"], words].concat());
        let first = advice["integrators"][0]["dt"].as_f64().unwrap();
        (first, advice["warnings"].to_string())
    };
    // At rest at first, but driven.
    let (driven, warnings) = largest(&["--force", "-10*q0 + sin(3*t)", "--q", "0"]);
    assert!(driven > 0.05 && !warnings.contains("kinks"), "{driven} {warnings}");
    // A difference quotient across the jump at the start would be a rate of 10⁸/s.
    let friction = ["--force", "-10*q0 - 0.5*sign(v0)", "--horizon", "1"];
    let (dry, warnings) = largest(&friction);
    assert!(dry > 0.01 && warnings.contains("kinks or jumps"), "{dry} {warnings}");
    // One whose stiffest rate, 1000/s, is far above that of the motion: the search goes on beyond 4 rad of it.
    let (stiff, warnings) = largest(&["--force", "-q0 - tanh(1000*v0)", "--horizon", "3"]);
    let is_warned = warnings.contains("may not resolve the motion");
    assert!(is_warned && (0.004..0.01).contains(&stiff), "{stiff} {warnings}");
    libration(&["advise", "--force", "-q0*q0", "--q", "0"])
        .code(2)
        .stderr(contains("nothing moves"));
}

#[test]
fn the_scale_of_an_energy_does_not_depend_on_its_constant() {
    let folder = tempfile::tempdir().unwrap();
    // Released at a right angle, where the energy is zero but for rounding, or 5, or 1000.
    let level = PENDULUM.replace("q = 1.2", "q = 1.5707963267948966");
    let advised = |constant: &str| {
        let text = format!("{level}energy = \"q'^2/2 - omega2*cos(q) + {constant}\"\n");
        let file = written(&folder, "level.toml", &text);
        let words = ["--tolerance", "energy=1e-4", "--horizon", "3.708149"];
        json(&[&["advise", "-q", "--system", file.to_str().unwrap()], &words[..]].concat())
    };
    let zero = advised("0");
    // The mean of q'²/2 = ω² cos q over a period is ω²·(2E/K − 1) at the modulus k² = ½, with E = 1.350644 and K = 1.854075: 0.456947·ω².
    // The period is 4K/ω, the horizon; seven digits of it and 0.05 rad of a step leave less than a thousandth.
    let scale = zero["tolerance"]["scale"].as_f64().unwrap();
    assert!((scale / (4.0 * 0.456947) - 1.0).abs() < 1e-3, "{scale}");
    assert_eq!(zero["verdict"]["outcome"], "within");
    for constant in ["5", "1000"] {
        let raised = advised(constant);
        for (name, wanted) in steps(&zero) {
            let found = steps(&raised)[&name];
            // The constant costs digits of the energy: 1e-13 of 1e-4, which a search resolves to 0.2 %.
            assert!(
                (found[0] / wanted[0].max(1e-300) - 1.0).abs() < 5e-3 || wanted[0] == 0.0,
                "{name} {constant}: {found:?} {wanted:?}"
            );
        }
    }
    // A parabolic orbit from its pericentre, whose energy is zero.
    let words = [
        "--q",
        "1,0",
        "--v",
        "0,1.4142135623730951",
        "--tolerance",
        "energy=1e-4",
        "--horizon",
        "5",
    ];
    let orbit = json(&[&["advise", "-q", "--system", "kepler"], &words[..]].concat());
    assert_eq!(orbit["verdict"]["outcome"], "within", "{orbit}");
}

#[test]
fn the_cheapest_is_searched_beyond_the_stiffest_rate_and_says_what_was_not_tried() {
    // Two bodies in polar coordinates: the derivatives by an angle exceed all rates of the motion, so that 4 rad of them are 0.0005 s.
    let text = "[system]\nname = \"polar\"\ncoordinates = [\"r\", \"phi\"]\nacceleration.r = \"r*phi'^2 - 10/r^2\"\n\
        acceleration.phi = \"-2*r'*phi'/r\"\nenergy = \"(r'^2 + r^2*phi'^2)/2 - 10/r\"\nstart = { r = 1.0, \"r'\" = 0.01, \"phi'\" = 1.1 }\n";
    let folder = tempfile::tempdir().unwrap();
    let file = written(&folder, "polar.toml", text);
    let file = file.to_str().unwrap();
    let words = ["advise", "-q", "--system", file, "--tolerance", "energy=1e-6", "--horizon", "5"];
    let advice = json(&words);
    // SciPy's coefficients of DOP853 with fixed steps keep 8.9e-7 of |E| = 9.395 at 0.002 s, with 6000 evaluations per second.
    let best = &advice["integrators"][0];
    assert_eq!(best["integrator"], "dormand-prince-8");
    assert!((0.0019..0.0022).contains(&best["dt"].as_f64().unwrap()), "{best}");
    let answer = advice["answer"].as_str().unwrap();
    assert!(answer.contains("the cheapest of 10 integrators that were tried"), "{answer}");
    assert!(
        answer.contains("Not tried: implicit integrators; steps of variable length"),
        "{answer}"
    );
    assert_eq!(advice["verdict"]["not_examined"][0], "implicit integrators");
    // Each integrator without a step says how far it was tried, in the table, in JSON and on the page.
    let euler = advice["integrators"]
        .as_array()
        .unwrap()
        .iter()
        .find(|one| one["integrator"] == "explicit-euler");
    assert!(euler.unwrap()["tried_down_to"].as_f64().unwrap() < 1e-5, "{euler:?}");
    libration(&words).success().stdout(contains("none to "));
}

#[test]
fn a_loop_at_a_jump_says_that_it_is_one() {
    let text = PENDULUM.replace("sin(q)", "sin(q) - 0.1*sign(q')");
    let folder = tempfile::tempdir().unwrap();
    let file = written(&folder, "dry.toml", &text);
    let words =
        ["advise", "--system", file.to_str().unwrap(), "--lqr", "1,1/1", "--period", "0.02"];
    libration(&words).stdout(contains("kinks or jumps"));
}

#[test]
fn a_loop_around_a_file_of_equations_is_that_of_its_plant() {
    let cart = example("cart_pole.toml");
    let lqr = ["--lqr", "1,10,0,1/0.1", "--period", "0.02", "--latency", "0.03"];
    let budget = |flag: &str, more: &[&str]| {
        let mut advice = json(&[&["advise", "-q", flag, &cart], &lqr[..], more].concat());
        let object = advice.as_object_mut().unwrap();
        object.retain(|key, _| key != "repeat_command" && key != "simulated");
        object["budgets"].as_array_mut().unwrap().iter_mut().for_each(|budget| {
            budget.as_object_mut().unwrap().remove("command");
        });
        advice
    };
    assert_eq!(budget("--system", &[]), budget("--plant", &[]));
    let heavier = budget("--system", &["--set", "pole=0.4"]);
    assert_ne!(heavier["budgets"], budget("--plant", &[])["budgets"]);
}

#[test]
fn a_loop_around_equations_is_closed_at_the_equilibrium_near_the_given_start() {
    let folder = tempfile::tempdir().unwrap();
    let text = PENDULUM
        .replace("sin(q)\"", "sin(q) + u\"")
        .replace("[\"q\"]", "[\"q\"]\ninputs = [\"u\"]");
    let file = written(&folder, "commanded.toml", &text);
    let loop_near = |start: &[&str]| {
        let words = ["advise", "-q", "--system", file.to_str().unwrap(), "--lqr", "1,1/1"];
        let advice = json(&[&words, start].concat());
        let point = advice["operating_point"]["states"][0]["value"].as_f64().unwrap();
        (point, advice["gain"].clone())
    };
    let (hanging, below) = loop_near(&[]);
    let (upright, above) = loop_near(&["--q", "3"]);
    assert!(hanging.abs() < 1e-9 && (upright - std::f64::consts::PI).abs() < 1e-9);
    assert_ne!(below, above);
    assert_eq!(loop_near(&["--start", "q=3"]), (upright, above));
}

#[test]
fn options_of_other_systems_are_refused_by_name() {
    let cart = example("cart_pole.toml");
    let refused = |words: &[&str], why: &str| {
        libration(&[&["advise"], words].concat())
            .code(2)
            .stderr(contains(why).and(contains("panicked").not()));
    };
    refused(&["--system", &cart, "--feedback", "1,1"], "--lqr or --gain");
    refused(&["--system", &cart, "--latency", "0.01"], "--latency is given, but there is no loop");
    refused(
        &["--system", &cart, "--lqr", "1/1", "--q", "1"],
        "--q, --start: `at` has 1 numbers; expected 2",
    );
    refused(
        &["--system", &cart, "--lqr", "1/1", "--v", "1"],
        "--v requires a system of the catalogue",
    );
    refused(&["--lqr", "1/1"], "--lqr is given without a plant");
    refused(&["--system", "pendulum", "--gain", "1"], "--gain is given without a plant");
    refused(&["--system", &cart, "--set", "mass=1"], "unknown parameter `mass`");
    let twice = ["--system", &cart, "--lqr", "1,1,1,1/1", "--set", "pole=1", "--set", "pole=2"];
    refused(&twice, "--set pole=2: the parameter is given twice");
    refused(&["--system", &cart, "--set", "pole=nan"], "--set pole=NaN: expected a finite number");
    refused(
        &["--force", "-k*q0", "--set", "k=1", "--set", "k=2"],
        "--set k=2: the parameter is given twice",
    );
    refused(
        &["--system", &cart, "--tolerance", "phase=0.1"],
        "a phase requires one degree of freedom",
    );
}
