//! `advise --redesign` of loops around linear plants.

use std::fs;

use predicates::prelude::*;

use super::advise::{json, libration};
use super::linear::{example, written};

#[test]
fn a_redesign_costs_less_and_pasted_into_the_file_costs_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for (name, table) in [
        ("magnetic_bearing.toml", "[controller.lqr]\nstates = [1e8, 1, 1]\ninputs = [0.01]\n"),
        (
            "two_mass_drive.toml",
            "[controller.lqr]\nstates = [1, 100, 0, 1]                          # motor angle, load angle, and their rates\ninputs = [0.1]\n",
        ),
    ] {
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
}

#[test]
fn a_redesign_of_a_pid_controller_requires_a_cost_and_misses_its_integral() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(example("quadrotor_attitude.toml")).unwrap();
    let without = text.replace("cost = { states = [1, 0.01], inputs = [0.01] }", "");
    assert_ne!(without, text);
    let path = written(&folder, "without.toml", &without);
    libration(&["advise", "--config", path.to_str().unwrap(), "--redesign"])
        .code(2)
        .stderr(predicate::str::contains("expected [controller.lqr], [controller.lqg], or `cost`"));
    libration(&["advise", "--config", &example("quadrotor_attitude.toml"), "--redesign"])
        .success()
        .stdout(predicate::str::contains("has integral action, and the redesign has none"))
        .stdout(predicate::str::contains("Optimal compensator"));
}
