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
            let step = "--integrator yoshida4 --dt 0.01 --steps 100 --save-every 50";
            let words: Vec<&str> = ["simulate"]
                .iter()
                .chain(system)
                .chain(&["--dtype", float])
                .copied()
                .chain(step.split(' '))
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
            vec!["simulate", "--system", &cart_pole, "--num-trajectories", "10", "--dtype", "f16"],
            "--dtype is f16",
        ),
        (vec!["simulate", "--system", &cart_pole, "--set", "pol=1"], "did you mean `pole`?"),
        (
            vec!["analyze", "--system", &cart_pole, "--q", "1"],
            "--q has 1 numbers; `cart-pole` has 2 coordinates",
        ),
        (vec!["simulate", "--system", "nowhere.toml"], "cannot read `nowhere.toml` (--system)"),
    ] {
        let steps = if words[0] == "simulate" { &step[..] } else { &step[..4] };
        let all: Vec<&str> = words.iter().copied().chain(steps.iter().copied()).collect();
        libration(&all).code(2).stderr(predicate::str::contains(part));
    }
}

#[test]
fn examples_are_listed_and_printed_as_files_that_work() {
    libration(&["list", "--examples"])
        .success()
        .stdout(predicate::str::contains("cart-pole"))
        .stdout(predicate::str::contains("van-der-pol"));
    let printed = libration(&["list", "--examples", "cart-pole"]).success();
    let text = fs::read_to_string(example("cart_pole.toml")).unwrap();
    assert_eq!(String::from_utf8_lossy(&printed.get_output().stdout), text);
    libration(&["list", "--examples", "cartpole"])
        .code(2)
        .stderr(predicate::str::contains("expected one of cart-pole, chain"));
}

#[test]
fn trajectories_of_an_ensemble_by_equations_are_single_ones_from_scaled_starts() {
    let folder = tempfile::tempdir().unwrap();
    // Time and a state of first order besides a coordinate.
    let text = |x: f64, s: f64| {
        format!(
            "[system]\nname = \"mine\"\ncoordinates = [\"x\"]\nacceleration.x = \"sin(t) - x + s\"\n\
             rate.s = \"-s*x\"\nenergy = \"x'^2/2 + x^2/2\"\nstart = {{ x = {x:?}, s = {s:?} }}\n"
        )
    };
    let rows = |name: &str, x: f64, s: f64, more: &[&str]| -> Vec<String> {
        let path = written(&folder, name, &text(x, s));
        let words = ["simulate", "--system", path.to_str().unwrap()];
        let step = ["--integrator", "velocity-verlet", "--dt", "0.01", "--steps", "30"];
        let words: Vec<&str> = words.iter().chain(&step).chain(more).copied().collect();
        let done = libration(&words).success();
        String::from_utf8_lossy(&done.get_output().stdout).lines().map(str::to_owned).collect()
    };
    let all = rows("all.toml", 1.0, 0.5, &["--num-trajectories", "3", "--spread", "0.5"]);
    assert_eq!(all[0], "trajectory,step,t,x,x',s,energy");
    for (n, scale) in [(0, 0.5), (1, 1.0), (2, 1.5)] {
        let alone = rows("one.toml", scale, 0.5 * scale, &[]);
        let own: Vec<&str> =
            all.iter().filter_map(|row| row.strip_prefix(&format!("{n},"))).collect();
        assert_eq!(own, alone[1..], "trajectory {n}");
    }
    libration(&["simulate", "--system", &example("lorenz.toml"), "--integrator", "rk4"])
        .code(2)
        .stderr(predicate::str::contains("--dt"));
}

#[test]
fn an_analysis_of_equations_derives_the_order_and_measures_it() {
    let analysis = |file: &str, method: &str, dt: &str| -> serde_json::Value {
        let path = example(file);
        let words = ["analyze", "--system", &path, "--integrator", method, "--dt", dt, "--json"];
        // An integrator that has lost its order does not resolve the motion: exit code 1.
        let done = libration(&words);
        serde_json::from_slice(&done.get_output().stdout).unwrap()
    };
    // Its forces depend on positions alone.
    let chain = analysis("chain.toml", "yoshida4", "0.01");
    assert_eq!(chain["motion"]["order"], 4);
    // Halved steps reduce errors of order four by 16, to the next order of the step.
    for error in chain["motion"]["errors"].as_array().unwrap() {
        let reduction = error["reduction"].as_f64().unwrap();
        assert!((reduction / 16.0 - 1.0).abs() < 1e-3, "{error}");
    }
    // A current and friction: integrators that kick and drift fall to order one.
    let motor = analysis("dc_motor.toml", "velocity-verlet", "0.0002");
    assert_eq!(motor["motion"]["order"], 1);
    assert_eq!(motor["motion"]["classical_order"], 2);
    for error in motor["motion"]["errors"].as_array().unwrap() {
        let reduction = error["reduction"].as_f64().unwrap();
        assert!((reduction / 2.0 - 1.0).abs() < 0.02, "{error}");
    }
    // An upright pole falls at the rate of the linearised equations: (g/l)·(4/3 − m/M)⁻¹ under its square root.
    let cart = analysis("cart_pole.toml", "rk4", "0.01");
    let rate = cart["linear"]["modes"][0]["growth_rate"].as_f64().unwrap();
    let wanted = (9.81 / 0.5 / (4.0 / 3.0 - 0.1 / 1.1_f64)).sqrt();
    assert!((rate / wanted - 1.0).abs() < 1e-12, "{rate} {wanted}");
    assert_eq!(cart["linear"]["states"][1]["name"], "theta");
    let step = cart["motion"]["spectral_radius"].as_f64().unwrap();
    let stability: f64 = [1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0]
        .iter()
        .rev()
        .fold(0.0, |sum, c| sum * 0.01 * rate + c);
    assert!((step - stability).abs() < 1e-12, "{step} {stability}");
}

#[test]
fn an_analysis_of_equations_says_what_it_cannot_say() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[system]\nname = \"driven\"\ncoordinates = [\"x\"]\nacceleration.x = \"abs(sin(t)) - x\"\n";
    let path = written(&folder, "driven.toml", text);
    let path = path.to_str().unwrap();
    let words = ["analyze", "--system", path, "--integrator", "rk4", "--dt", "0.01"];
    libration(&[&words[..], &["--verbose"]].concat())
        .success()
        .stdout(predicate::str::contains("kinks or jumps"))
        .stdout(predicate::str::contains("the system has none, so nothing is said of its drift"))
        .stdout(predicate::str::contains("No modes: `driven` depends on time"));
    let refused = |more: &[&str]| {
        let words: Vec<&str> = words.iter().chain(more).copied().collect();
        libration(&words).code(2)
    };
    refused(&["--feedback", "1,2"]).stderr(predicate::str::contains("--plant"));
    refused(&["--max-drift", "1e-3"]).stderr(predicate::str::contains("--max-drift requires"));
    let exact = ["analyze", "--system", path, "--integrator", "exact", "--dt", "0.01"];
    libration(&exact).code(2).stderr(predicate::str::contains("require a linear system"));
}

#[test]
fn equations_are_a_plant_for_analyses_and_budgets_in_their_own_names() {
    let path = example("cart_pole.toml");
    libration(&["analyze", "--plant", &path])
        .success()
        .stdout(predicate::str::contains("theta', 0.25 theta"));
    let folder = tempfile::tempdir().unwrap();
    let config = |at: &str| {
        format!(
            "[system.linear]\nof = {path:?}\nparameters = {{ pole = 0.2 }}\n{at}\n\
             [controller.lqr]\nstates = [1, 10, 0, 1]\ninputs = [0.1]\n[loop]\nperiod = 0.02\nlatency = 0.03\n"
        )
    };
    let advised = |at: &str| {
        let file = written(&folder, "loop.toml", &config(at));
        libration(&["advise", "--config", file.to_str().unwrap()])
    };
    advised("").success().stdout(predicate::str::contains(
        "the system cart-pole linearised at x = 0 m, theta = 0 rad under u = 0 N",
    ));
    // Hanging, by name.
    advised("at = { theta = 3.0 }").success().stdout(predicate::str::contains("theta = 3.141593"));
    advised("at = { tetha = 3.0 }")
        .code(2)
        .stderr(predicate::str::contains("did you mean `theta`"));
    advised("at = [1, 2, 3]").code(2).stderr(predicate::str::contains("expected 2: x, theta"));
}

#[test]
fn an_expression_on_the_command_line_is_a_system() {
    let step = ["--integrator", "rk4", "--dt", "0.01", "--steps", "50"];
    let rows = |system: &[&str]| -> Vec<u8> {
        let words: Vec<&str> = ["simulate"].iter().chain(system).chain(&step).copied().collect();
        let output = libration(&words).success().get_output().stdout.clone();
        // After the names of the columns.
        output.splitn(2, |&byte| byte == b'\n').nth(1).unwrap().to_vec()
    };
    let expression = ["--force", "-k*q0 - c*v0", "--set", "k=10", "--set", "c=0.3", "--q", "2"];
    let named = String::from_utf8(rows(&expression)).unwrap();
    let known = ["--system", "damped-oscillator", "--set", "omega2=10", "--set", "gamma=0.3"];
    let compiled =
        String::from_utf8(rows(&[&known[..], &["--q", "2", "--v", "0"]].concat())).unwrap();
    // The last column of the catalogue is its energy.
    for (own, row) in named.lines().zip(compiled.lines()) {
        assert_eq!(Some(own), row.rsplit_once(',').map(|(state, _)| state));
    }
    assert_eq!(named.lines().count(), 51);
    for (words, part) in [
        (vec!["--force", "-k*q0"], "unknown name `k`"),
        (vec!["--force", "-q0", "--q", "1,2"], "has 2 numbers for 1 of --force"),
        (vec!["--force", "-q0", "--system", "oscillator"], "cannot be used with"),
    ] {
        let words: Vec<&str> = ["simulate"].into_iter().chain(words).chain(step).collect();
        libration(&words).code(2).stderr(predicate::str::contains(part));
    }
    // A cubic friction: an integrator that kicks and drifts has order one, though it starts at rest.
    let words = ["analyze", "--force", "-10*q0 - 0.1*v0^3", "--integrator", "velocity-verlet"];
    let words: Vec<&str> = words.into_iter().chain(["--dt", "0.01", "--json"]).collect();
    let done = libration(&words).success();
    let found: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    assert_eq!(found["motion"]["order"], 1);
    let table = ["--integrator", "mclachlan-atela-5", "--dt", "0.01", "--steps", "1"];
    let words = [&["simulate", "--force", "-10*q0 - 0.1*v0^3"][..], &table].concat();
    let note = "a force of `force` depends on a velocity";
    libration(&words).success().stderr(predicate::str::contains(note));
}
