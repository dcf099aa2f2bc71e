//! Systems by equations, through the binary.

use std::fs;
use std::path::Path;

use predicates::prelude::*;

use super::advise::libration;
use super::linear::written;

fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/systems").join(name);
    path.to_string_lossy().into_owned()
}

#[test]
fn a_file_of_equations_is_listed_with_what_follows_from_it() {
    libration(&["list", &example("cart_pole.toml")])
        .success()
        .stdout(predicate::str::contains("cart-pole: A pole on a cart"))
        .stdout(predicate::str::contains("theta   0.1"))
        .stdout(predicate::str::contains("length  0.5 m"))
        .stdout(predicate::str::contains("Inputs: u"))
        .stdout(predicate::str::contains("no polynomials; accelerations depend on velocities"));
    let listed = libration(&["list", &example("lorenz.toml"), "--json"]).success();
    let summary: serde_json::Value = serde_json::from_slice(&listed.get_output().stdout).unwrap();
    assert_eq!(summary["polynomial_degree"], 2);
    assert_eq!(summary["states"].as_array().unwrap().len(), 3);
    // At the origin of the Duffing oscillator with a double well the slopes are −1 and 1.
    let folder = tempfile::tempdir().unwrap();
    let text = "[system]\nname = \"well\"\ncoordinates = [\"x\"]\nacceleration.x = \"x - x^3\"\n";
    let path = written(&folder, "well.toml", text);
    let listed = libration(&["list", path.to_str().unwrap(), "--json"]).success();
    let summary: serde_json::Value = serde_json::from_slice(&listed.get_output().stdout).unwrap();
    assert_eq!(summary["positional"], true);
    let mut rates: Vec<f64> = summary["eigenvalues_at_start"]
        .as_array()
        .unwrap()
        .iter()
        .map(|value| value[0].as_f64().unwrap())
        .collect();
    rates.sort_by(f64::total_cmp);
    assert!((rates[0] + 1.0).abs() < 1e-15 && (rates[1] - 1.0).abs() < 1e-15, "{rates:?}");
}

#[test]
fn a_pendulum_by_equations_has_the_trajectory_of_the_catalogue() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[system]\nname = \"mine\"\ncoordinates = [\"q0\"]\nparameters = { g = 9.0 }\n\
                acceleration.q0 = \"-g*sin(q0)\"\nenergy = \"q0'^2/2 + g*(1 - cos(q0))\"\nstart = { q0 = 2 }\n";
    let path = written(&folder, "mine.toml", text);
    for float in ["f64", "f32", "f16", "bf16"] {
        let rows = |system: &[&str]| {
            let step =
                ["--integrator", "yoshida4", "--dt", "0.01", "--steps", "100", "--every", "50"];
            let words: Vec<&str> = ["simulate"]
                .iter()
                .chain(system)
                .chain(&step)
                .chain(&["--float", float])
                .copied()
                .collect();
            let run = libration(&words).success();
            let text = String::from_utf8(run.get_output().stdout.clone()).unwrap();
            let row = |line: &str| line.split(',').take(4).map(str::to_owned).collect::<Vec<_>>();
            text.lines().skip(1).map(row).collect::<Vec<_>>()
        };
        let own = rows(&["--system", path.to_str().unwrap(), "--set", "g=9.81"]);
        assert_eq!(own, rows(&["--system", "pendulum"]), "{float}");
        assert_eq!(own.len(), 3);
    }
}

#[test]
fn wrong_files_and_options_name_the_place_and_what_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(example("cart_pole.toml")).unwrap();
    for (name, from, to, parts) in [
        (
            "a.toml",
            "g*sin(theta) -",
            "g*sin(thta) -",
            &["unknown name `thta`", "did you mean `theta`?", "^^^^"][..],
        ),
        (
            "b.toml",
            "g*sin(theta) -",
            "g*sine(theta) -",
            &["unknown function `sine`", "did you mean `sin`?"],
        ),
        ("c.toml", "inputs = [\"u\"]", "inputs = [\"g\"]", &["`g` is given twice"]),
        ("d.toml", "start = { theta", "start = { angle", &["unknown state `angle`", "`theta'`"]),
        ("e.toml", "description", "about", &["unknown key `about`"]),
        ("f.toml", "coordinates = [\"x\", ", "coordinates = [", &["`x` is no coordinate"]),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{name}");
        let path = written(&folder, name, &changed);
        for part in parts {
            libration(&["list", path.to_str().unwrap()])
                .code(2)
                .stderr(predicate::str::contains(*part));
        }
    }
    let cart_pole = example("cart_pole.toml");
    let step = ["--integrator", "rk4", "--dt", "0.01", "--steps", "10"];
    for (words, part) in [
        (
            vec!["simulate", "--system", &cart_pole, "--count", "10"],
            "--count requires a system of the catalogue",
        ),
        (vec!["simulate", "--system", &cart_pole, "--set", "pol=1"], "did you mean `pole`?"),
        (vec!["analyze", "--system", &cart_pole], "knows systems of the catalogue only"),
        (vec!["simulate", "--system", "nowhere.toml"], "cannot read `nowhere.toml` (--system)"),
    ] {
        let steps = if words[0] == "simulate" { &step[..] } else { &step[..4] };
        let all: Vec<&str> = words.iter().copied().chain(steps.iter().copied()).collect();
        libration(&all).code(2).stderr(predicate::str::contains(part));
    }
}
