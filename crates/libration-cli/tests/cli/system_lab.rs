//! `lab --system`, through the binary.

use std::fs;
use std::path::Path;

use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};

use super::actions::assert_parses;
use super::advise::libration;
use super::linear::written;

/// Runs studies of a file, and returns the page and the results.
fn report(file: &str, words: &[&str]) -> (String, Value) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let all = [&["--quiet", "lab", "--system", file, "--effort", "quick", "--out", out], words];
    libration(&all.concat()).success();
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    let results = fs::read(folder.path().join("results.json")).unwrap();
    (page, serde_json::from_slice(&results).unwrap())
}

pub(super) fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/systems").join(name);
    path.to_string_lossy().into_owned()
}

/// What a page about a system of equations never has: the oscillator of the configuration, systems of the catalogue, and claims.
const FOREIGN: [&str; 8] = [
    "Oscillator, m",
    "k = 10",
    "Hénon",
    "Kepler",
    "Duffing",
    "source report",
    "table of claims",
    "#ledger",
];

fn has_only_its_own(page: &str, states: &[&str]) {
    // The scripts of figures and of the live section know words of their own.
    let behind = |part: &str| {
        part.split_once("</script>").map_or(String::new(), |(_, rest)| rest.to_owned())
    };
    let mut parts = page.split("<script");
    let text = parts.next().unwrap().to_owned() + &parts.map(behind).collect::<String>();
    for word in FOREIGN {
        assert!(!text.contains(word), "{word}");
    }
    for state in states {
        assert!(text.contains(&format!("<td>{state}</td>")), "{state}");
    }
}

/// The commands in the boxes of what to do.
fn recommended(page: &str) -> Vec<String> {
    let boxes =
        page.split("<div class=\"do\">").skip(1).map(|rest| rest.split("</div>").next().unwrap());
    let codes = boxes.flat_map(|own| own.split("<code>libration ").skip(1));
    let text = codes.map(|rest| rest.split("</code>").next().unwrap());
    let without_tags =
        |text: &str| text.replace("<span class=\"option\">", "").replace("</span>", "");
    text.map(|text| format!("libration {}", without_tags(text))).collect()
}

fn not_applicable<'a>(results: &'a Value, study: &str) -> Option<&'a str> {
    let all = results["not_applicable"].as_array().unwrap();
    all.iter().find(|other| other["study"] == study)?["because"].as_str()
}

#[test]
fn the_report_on_a_system_has_its_own_states_and_every_study_or_the_reason() {
    let (page, results) = report(&example("van_der_pol.toml"), &["--set", "mu=0.8"]);
    has_only_its_own(&page, &["x", "x'"]);
    assert!(page.contains("--set mu=0.8"));
    let commands = recommended(&page);
    assert!(commands.len() >= 4, "{commands:?}");
    for command in commands {
        let names_it = command.contains("van_der_pol.toml --set mu=0.8");
        assert!(names_it || command.starts_with("libration compare"), "{command}");
        assert_parses(&command);
    }
    let studies = results["studies"].as_array().unwrap();
    let ran: Vec<&str> = studies.iter().map(|study| study["name"].as_str().unwrap()).collect();
    assert_eq!(ran, ["determinism", "precision", "convergence", "stability"]);
    for study in libration_lab::STUDIES.studies {
        let name = study.name();
        assert_eq!(ran.contains(&name), not_applicable(&results, name).is_none(), "{name}");
    }
    assert_eq!(not_applicable(&results, "nonlinear"), Some("the file has no `energy`"));
    assert!(not_applicable(&results, "latency").unwrap().contains("libration advise --plant"));
    for key in ["start", "drift"] {
        assert!(results["config"].get(key).is_none(), "{key}");
    }
    assert_eq!(results["config"]["system"], json!({ "equations": "Van der Pol" }));
    assert_eq!(results["system"]["parameters"][0]["value"], 0.8);
    // A state that is not there would not have been found.
    let orders = studies.iter().flat_map(|study| study["findings"].as_array().unwrap());
    let verlet = "convergence.Van-der-Pol.velocity-verlet.global-order";
    let order = orders.clone().find(|finding| finding["id"] == verlet).unwrap();
    assert_eq!(order["predicted"], 1.0);
}

#[test]
fn the_energy_of_a_system_is_studied_if_its_motion_conserves_it() {
    let folder = tempfile::tempdir().unwrap();
    let text = |friction: f64| {
        format!(
            "[system]\nname = \"swing\"\ncoordinates = [\"tilt\"]\nparameters = {{ g = 9.81, friction = {friction} }}\n\
             acceleration.tilt = \"-g*sin(tilt) - friction*tilt'\"\n\
             energy = \"tilt'^2/2 + g*(1 - cos(tilt))\"\nstart = {{ tilt = 1.5 }}\nunits = {{ tilt = \"rad\" }}\n"
        )
    };
    let free = written(&folder, "free.toml", &text(0.0));
    let (page, results) = report(free.to_str().unwrap(), &["nonlinear"]);
    has_only_its_own(&page, &["tilt", "tilt'"]);
    assert!(!page.split("<script").next().unwrap().contains("scillator"));
    let findings = results["studies"][0]["findings"].as_array().unwrap();
    let of = |id: &str| findings.iter().find(|finding| finding["id"] == id).unwrap();
    assert_eq!(of("nonlinear.swing.rk4.rate-order")["predicted"], 5.0);
    assert_eq!(of("nonlinear.swing.velocity-verlet.symplecticity")["predicted"], 0.0);
    let damped = written(&folder, "damped.toml", &text(0.1));
    libration(&["lab", "nonlinear", "--system", damped.to_str().unwrap()])
        .code(2)
        .stderr(contains("`nonlinear` does not apply").and(contains("does not conserve")));
}

#[test]
fn wrong_systems_of_the_laboratory_are_shown_at_the_place() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[system]\nname = \"a\"\ncoordinates = [\"x\"]\nacceleration.x = \"-sin(y)\"\n";
    let wrong = written(&folder, "wrong.toml", text);
    libration(&["lab", "--system", wrong.to_str().unwrap()])
        .code(2)
        .stdout("")
        .stderr(contains("unknown name `y`").and(contains("wrong.toml:4:24")).and(contains("^")));
    let nowhere = written(&folder, "root.toml", &text.replace("-sin(y)", "sqrt(-1 - x^2)"));
    libration(&["lab", "--system", nowhere.to_str().unwrap()])
        .code(2)
        .stderr(contains("acceleration.x is NaN at the start").and(contains("root.toml:4:")));
    let lorenz = example("lorenz.toml");
    let cases: &[(&[&str], &str)] = &[
        (&["lab", "latency", "--system", &lorenz], "libration advise --plant"),
        (&["lab", "--system", &lorenz, "--set", "rh=28"], "unknown parameter `rh`"),
        (&["lab", "--system", "pendulum"], "expected a file of equations"),
        (&["lab", "--set", "rho=28"], "--system"),
        (&["lab", "--system", "nowhere.toml"], "cannot read `nowhere.toml` (--system)"),
    ];
    for (words, message) in cases {
        libration(words).code(2).stdout("").stderr(contains(*message));
    }
}

#[test]
fn ordinary_systems_have_no_study_that_disagrees() {
    let folder = tempfile::tempdir().unwrap();
    for (name, equations) in [
        (
            "light damping",
            "acceleration.x = \"-x - 0.2*x'\"\ncoordinates = [\"x\"]\nstart = { x = 1 }",
        ),
        (
            "hardly any",
            "acceleration.x = \"-x - 0.001*x'\"\ncoordinates = [\"x\"]\nstart = { x = 1 }",
        ),
        ("first order", "rate.th = \"w\"\nrate.w = \"-9.81*sin(th)\"\nstart = { th = 1 }"),
        ("prey", "rate.x = \"x*(1 - y)\"\nrate.y = \"y*(x - 1)\"\nstart = { x = 1.2, y = 1 }"),
        (
            "magnetic",
            "acceleration.x = \"10*y' - x\"\nacceleration.y = \"-10*x' - y\"\ncoordinates = [\"x\", \"y\"]\nstart = { x = 1 }",
        ),
        ("no linear part", "acceleration.x = \"-x^3\"\ncoordinates = [\"x\"]\nstart = { x = 1 }"),
    ] {
        let text = format!("[system]\nname = \"{name}\"\n{equations}\n");
        let file = written(&folder, "own.toml", &text);
        let file = file.to_str().unwrap();
        let (_, results) = report(file, &["precision"]);
        let because = not_applicable(&results, "stability");
        assert_eq!(because.is_some(), name == "no linear part", "{name}: {because:?}");
        // A study that disagrees is a failed run.
        if because.is_none() {
            report(file, &["stability"]);
        }
    }
}

#[test]
fn what_does_not_move_and_what_time_moves_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let reasons = |equations: &str| {
        let text = format!("[system]\nname = \"own\"\ncoordinates = [\"x\"]\n{equations}\n");
        let file = written(&folder, "own.toml", &text);
        let (_, results) = report(file.to_str().unwrap(), &["determinism"]);
        let reason = |study| not_applicable(&results, study).map(str::to_owned);
        ["convergence", "precision", "stability"].map(reason)
    };
    let [convergence, precision, _] = reasons("acceleration.x = \"-4*x\"");
    assert_eq!(convergence, precision);
    assert!(convergence.unwrap().contains("nothing moves"));
    let [convergence, precision, stability] = reasons("acceleration.x = \"-x + sin(t)\"");
    assert_eq!([convergence, precision], [None, None]);
    assert!(stability.unwrap().contains("depends on time"));
}

#[test]
fn where_no_theory_predicts_a_stable_step_it_is_measured_and_named_as_such() {
    let motor = example("dc_motor.toml");
    let (page, results) = report(&motor, &["stability"]);
    assert!(page.contains("velocity Verlet 36.9 ms (measured alone)"));
    let findings = results["studies"][0]["findings"].as_array().unwrap();
    let own = |finding: &&Value| finding["id"] == "stability.velocity-verlet.limit";
    let limit = findings.iter().find(own).unwrap();
    assert_eq!((&limit["predicted"], &limit["verdict"]), (&Value::Null, &json!("measured")));
    // The multipliers that `analyze` finds pass the unit circle there.
    let limit = limit["measured"].as_f64().unwrap();
    for (factor, is_stable) in [(0.999, true), (1.001, false)] {
        let dt = format!("{:?}", factor * limit);
        let words = ["analyze", "--system", &motor, "--integrator", "velocity-verlet", "--json"];
        // Near the limit ten steps do not resolve the motion: exit code 1.
        let done = libration(&[&words[..], &["--dt", &dt, "--steps", "10"]].concat()).code(1);
        let found: Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
        let radius = found["motion"]["spectral_radius"].as_f64().unwrap();
        assert_eq!(radius < 1.0, is_stable, "{dt}: {radius}");
    }
    // A system that grows by nature says so, in place of limits.
    let (page, _) = report(&example("magnetic_bearing.toml"), &["stability"]);
    assert!(page.contains("The system is unstable at its equilibrium: a mode grows"));
}

#[test]
fn errors_outside_of_the_range_of_an_order_are_undecided_and_no_disagreement() {
    let folder = tempfile::tempdir().unwrap();
    let polar = "coordinates = [\"r\", \"phi\"]\nacceleration.r = \"r*phi'^2 - 10/r^2\"\n\
        acceleration.phi = \"-2*r'*phi'/r\"\nstart = { r = 1.0, \"r'\" = 0.01, \"phi'\" = 1.1 }\n";
    let thrust = "coordinates = [\"x\", \"y\"]\nlet = { r = \"sqrt(x^2 + y^2)\", s = \"sqrt(x'^2 + y'^2)\" }\n\
        acceleration.x = \"-398600.4418*x/r^3 + 1e-6*x'/s\"\nacceleration.y = \"-398600.4418*y/r^3 + 1e-6*y'/s\"\n\
        start = { x = 7000.0, \"y'\" = 7.546 }\n";
    // A force of a millionth depends on the velocity: velocity Verlet has order 1, with a coefficient of a millionth.
    let friction =
        "coordinates = [\"x\"]\nacceleration.x = \"-x - 1e-6*x'\"\nstart = { x = 1.0 }\n";
    let gyroscope = "coordinates = [\"x\", \"y\"]\nacceleration.x = \"-10*x + 1e-5*y'\"\n\
        acceleration.y = \"-7*y - 1e-5*x'\"\nstart = { x = 1.0, y = 0.4 }\n";
    for (name, text, method) in [
        ("polar", polar, "rk4"),
        ("thrust", thrust, "velocity-verlet"),
        ("friction", friction, "velocity-verlet"),
        ("gyroscope", gyroscope, "velocity-verlet"),
    ] {
        let text = format!("[system]\nname = \"{name}\"\n{text}");
        let file = written(&folder, &format!("{name}.toml"), &text);
        // The exit code is 0: the findings that are judged agree.
        let (_, results) = report(file.to_str().unwrap(), &["convergence"]);
        let kind = if name == "thrust" { "local" } else { "global" };
        let id = format!("convergence.{name}.{method}.{kind}-order");
        let findings = results["studies"][0]["findings"].as_array().unwrap();
        let own = findings.iter().find(|finding| finding["id"] == id.as_str()).unwrap();
        let why = own["text"].as_str().unwrap();
        assert!(own["predicted"].is_null() && why.contains("undecided: at the steps"), "{own}");
    }
}
