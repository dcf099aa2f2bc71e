//! Weights, periods and ranges of loops around linear plants.

use std::fs;

use predicates::prelude::*;

use super::advise::{json, libration};
use super::linear::written;

#[test]
fn weights_of_outputs_are_those_of_the_states_that_they_show() {
    let folder = tempfile::tempdir().unwrap();
    let text = |weights: &str| {
        format!(
            "[system.linear]\na = [[0, 1], [-4, -0.5]]\nb = [[0], [1]]\nc = [[2, 1]]\n\
             [controller.lqr]\n{weights}\ninputs = [0.1]\n[loop]\nperiod = 0.05\n"
        )
    };
    let advice = |name: &str, weights: &str| {
        let path = written(&folder, name, &text(weights));
        json(&["advise", "--config", path.to_str().unwrap()])
    };
    // 3 y² = 3 (2 x₁ + x₂)², and with 1 of x₁².
    let outputs = advice("outputs.toml", "outputs = [3]");
    let states = advice("states.toml", "states = [[12, 6], [6, 3]]");
    assert_eq!(outputs["controller_matrices"], states["controller_matrices"]);
    assert_eq!(outputs["cost"], states["cost"]);
    let both = advice("both.toml", "states = [1, 0]\noutputs = [3]");
    assert_eq!(
        both["controller_matrices"],
        advice("sum.toml", "states = [[13, 6], [6, 3]]")["controller_matrices"]
    );
    for (name, text, parts) in [
        ("none.toml", text(""), ["no weights of `states` or `outputs`", "inputs = [0.1]"]),
        (
            "long.toml",
            text("outputs = [1, 2]"),
            ["`outputs` has 2 numbers; expected 1", "outputs = [1, 2]"],
        ),
        (
            "direct.toml",
            text("outputs = [1]").replace("c = [[2, 1]]", "c = [[2, 1]]\nd = [[1]]"),
            [
                "`outputs` are weighted, but inputs act on them directly",
                "expected weights of `states`",
            ],
        ),
    ] {
        let path = written(&folder, name, &text);
        for part in parts {
            libration(&["advise", "--config", path.to_str().unwrap()])
                .code(2)
                .stderr(predicate::str::contains(part));
        }
    }
}

#[test]
fn a_sampled_plant_keeps_its_period() {
    let folder = tempfile::tempdir().unwrap();
    let text = "a = [[1, 0.1], [0, 0.95]]\nb = [[0.005], [0.1]]\nsampling-period = 0.1\n";
    let path = written(&folder, "sampled.toml", text);
    let plant = path.to_str().unwrap();
    let advice = json(&["advise", "--plant", plant, "--lqr", "1,1/1", "--latency", "2steps"]);
    assert_eq!(advice["period"], 0.1);
    assert_eq!(advice["budgets"][0]["stated"], 0.2);
    for command in [&["analyze"][..], &["simulate", "--steps", "3"]] {
        let words: Vec<&str> =
            command.iter().copied().chain(["--plant", plant, "--lqr", "1,1/1"]).collect();
        libration(&words).success();
    }
    libration(&["advise", "--plant", plant, "--lqr", "1,1/1", "--period", "0.05"]).code(2);
}

/// A lightly damped mass whose loop is unstable with losses between 0.9141 and 0.99 only (eigenvalues of its second moments, NumPy).
const OSCILLATOR: &str = "\
[system.linear]
a = [[0, 1], [-100, -0.1]]
b = [[0], [1]]
[controller.state-feedback]
gain = [[-5, 5]]
[loop]
period = 0.02
latency = 0.01
cost = { states = [1, 1], inputs = [0.1] }
";

#[test]
fn ranges_of_a_redesign_end_at_windows_and_pages_name_later_windows() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "oscillator.toml", OSCILLATOR);
    let page = folder.path().join("page.html");
    let words = ["advise", "--config", path.to_str().unwrap(), "--page", page.to_str().unwrap()];
    libration(&words).success();
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("latency alone is stable again from 0.608"), "no later window");
    let advice = json(&["advise", "--config", path.to_str().unwrap(), "--redesign"]);
    let limits = advice["redesign"]["limits"].as_array().unwrap();
    let loss = limits.iter().find(|limit| limit["kind"] == "loss").unwrap();
    let end = loss["given"]["to"].as_f64().unwrap();
    assert!((end - 0.9141).abs() < 1e-4, "{end}");
}
