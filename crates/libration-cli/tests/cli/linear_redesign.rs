//! `advise --redesign` of loops around linear plants.

use std::fs;

use predicates::prelude::*;

use super::advise::{json, libration};
use super::linear::{example, written};

#[test]
fn a_redesign_costs_less_and_pasted_into_the_file_costs_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let name = "magnetic_bearing.toml";
    let table = "[controller.lqr]\nstates = [1e8, 1, 1]\ninputs = [0.01]\n";
    let advice = json(&["advise", "--config", &example(name), "--redesign"]);
    let redesign = &advice["redesign"];
    assert!(redesign["cost"].as_f64() < advice["cost"].as_f64(), "{redesign}");
    let given = fs::read_to_string(example(name)).unwrap();
    let toml = redesign["toml"].as_str().unwrap();
    let (rest, own) = toml.split_at(toml.find("[controller").unwrap());
    let pasted = given.replace(table, own).replace("[loop]\n", &format!("[loop]\n{rest}"));
    assert_ne!(pasted, given);
    let path = written(&folder, "pasted.toml", &pasted);
    let again = json(&["advise", "--config", path.to_str().unwrap()]);
    let costs = [&redesign["cost"], &again["cost"]].map(|cost| cost.as_f64().unwrap());
    // All digits are in the file.
    assert!((costs[0] / costs[1] - 1.0).abs() < 1e-12, "{name}: {costs:?}");
    let limits = redesign["limits"].as_array().unwrap();
    for limit in limits.iter().filter(|limit| limit["kind"] == "latency") {
        assert!(limit["redesigned"]["to"].as_f64() > limit["given"]["to"].as_f64(), "{limit}");
    }
}

/// A PID controller of the attitude of a body with friction.
const PID: &str = "\
[system.linear]
a = [[0, 1], [0, -2]]
b = [[0], [1]]
c = [[1, 0]]
[[controller.pid]]
output = \"y1\"
input = \"u1\"
proportional = 10
integral = 2
derivative = 3
filter = 0.02
[loop]
period = 0.02
jitter = 0.05
measurement-noise = [1e-6]
";

#[test]
fn a_redesign_of_a_pid_controller_requires_a_cost_and_misses_its_integral() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "without.toml", PID);
    libration(&["advise", "--config", path.to_str().unwrap(), "--redesign"])
        .code(2)
        .stderr(predicate::str::contains("expected [controller.lqr], [controller.lqg], or `cost`"));
    let text = format!("{PID}cost = {{ states = [1, 0.01], inputs = [0.01] }}\n");
    let path = written(&folder, "with.toml", &text);
    libration(&["advise", "--config", path.to_str().unwrap(), "--redesign", "--verbose"])
        .success()
        .stdout(predicate::str::contains("has integral action, and the redesign has none"))
        .stdout(predicate::str::contains("Optimal compensator"));
}
