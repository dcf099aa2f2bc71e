//! `libration advise` for loops around linear plants, through the binary.

use std::fs;
use std::path::{Path, PathBuf};

use predicates::prelude::*;
use serde_json::Value;

use super::advise::{json, libration};

pub(crate) fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/loops").join(name);
    path.to_string_lossy().into_owned()
}

pub(crate) fn written(folder: &tempfile::TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    path
}

/// The largest stable size of a budget.
fn limit(advice: &Value, kind: &str, channel: Option<&str>) -> Option<f64> {
    let own = |budget: &&Value| {
        budget["kind"] == kind && budget.get("channel").and_then(Value::as_str) == channel
    };
    let budget = advice["budgets"].as_array().unwrap().iter().find(own);
    budget.unwrap_or_else(|| panic!("{kind} {channel:?}"))["stable_up_to"].as_f64()
}

pub(crate) const OSCILLATOR: &str = "\
[system.linear]
a = [[0, 1], [-10, 0]]
b = [[0], [1]]
[controller.state-feedback]
gain = [[10, 2]]
[loop]
period = 0.01
cost = { states = [5, 0.5], inputs = [1e-12] }
";

#[test]
fn an_oscillator_of_the_catalogue_and_the_same_one_in_matrices_have_the_same_limits() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(&folder, "oscillator.toml", OSCILLATOR);
    let general = json(&["advise", "--config", file.to_str().unwrap(), "--loss", "0.1"]);
    let own = json(&[
        "advise",
        "--system",
        "oscillator",
        "--set",
        "omega2=10",
        "--feedback",
        "10,2",
        "--loss",
        "0.1",
    ]);
    for kind in ["latency", "jitter", "skew", "loss"] {
        let general = limit(&general, kind, None);
        let own = limit(&own["loop"], kind, None);
        match general.zip(own) {
            // One by the crossings of the unit circle in 1024 bits, the other by bisection in floats.
            Some((general, own)) => {
                assert!((general / own - 1.0).abs() < 1e-10, "{kind}: {general} {own}");
            }
            None => assert_eq!(general, own, "{kind}"),
        }
    }
    for key in ["growth", "cost", "ideal_cost"] {
        let [general, own] =
            [&general[key], &own["loop"]["combined"][key]].map(|x| x.as_f64().unwrap());
        // Weights of inputs of 10⁻¹² are those of the general loop alone.
        assert!((general / own - 1.0).abs() < 1e-9, "{general} {own}");
    }
}

#[test]
fn the_same_plant_in_every_kind_of_file_gets_the_same_answer() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        (
            "p.toml",
            "a = [[0, 1], [4, -0.2]]\nb = [[0], [1]]\nstates = [\"angle (rad)\", \"rate (rad/s)\"]",
        ),
        (
            "p.json",
            r#"{"a": [[0, 1], [4, -0.2]], "b": [[0], [1]], "states": ["angle (rad)", "rate (rad/s)"]}"#,
        ),
        (
            "p.csv",
            "# a pendulum\nA, 0, 1\nA, 4, -0.2\nB, 0\nB, 1\nstates, angle (rad), rate (rad/s)\n",
        ),
    ];
    let answers: Vec<Value> = files
        .iter()
        .map(|(name, text)| {
            let path = written(&folder, name, text);
            let path = path.to_str().unwrap();
            let mut advice =
                json(&["advise", "--plant", path, "--lqr", "10,1/0.1", "--latency", "0.02"]);
            advice["repeat_command"] = Value::Null;
            for budget in advice["budgets"].as_array_mut().unwrap() {
                budget["command"] = Value::Null;
            }
            advice
        })
        .collect();
    assert!(answers.iter().all(|answer| *answer == answers[0]));
    assert_eq!(answers[0]["states"][0]["name"], "angle");
    assert_eq!(answers[0]["states"][1]["unit"], "rad/s");
    assert!(limit(&answers[0], "output-latency", Some("rate")).unwrap() > 0.0);
}

#[test]
fn examples_hold_and_their_pages_name_their_channels() {
    let folder = tempfile::tempdir().unwrap();
    for (name, words) in [
        (
            "cascade.toml",
            ["velocity filter", "hold (half of 5 periods)", "not available for a cascade"],
        ),
        ("magnetic_bearing.toml", ["voltage", "gap", "command"]),
        ("quadrotor_attitude.toml", ["gyroscope filter", "rotors", "attitude"]),
        ("two_mass_drive.toml", ["motor lag", "load angle", "hold (half a period)"]),
    ] {
        let page = folder.path().join("page.html");
        libration(&["advise", "--config", &example(name), "--page", page.to_str().unwrap()])
            .success()
            .stdout(predicate::str::contains("part of the latency"));
        let page = fs::read_to_string(page).unwrap();
        assert!(words.iter().all(|word| page.contains(word)), "{name}");
    }
}

#[test]
fn narrow_windows_beside_whole_periods_are_seen_where_a_direct_path_opens_them() {
    let folder = tempfile::tempdir().unwrap();
    // Found by a program that was written apart, from the definition of the loop: 0.7713 periods, though 0.8 to 9 are stable in part.
    let text = "\
[system.linear]
a = [[-0.68]]
b = [[1]]
c = [[1]]
d = [[-0.78]]
[controller.state-space]
d = [[1.02]]
[loop]
period = 1.0
";
    let path = written(&folder, "direct.toml", text);
    let advice = json(&["advise", "--config", path.to_str().unwrap()]);
    for kind in ["latency", "output-latency"] {
        let found = limit(&advice, kind, None).unwrap();
        assert!((found - 0.77128).abs() < 1e-5, "{kind}: {found}");
    }
}

#[test]
fn plants_and_controllers_that_do_not_fit_are_usage_errors_that_name_the_key() {
    let folder = tempfile::tempdir().unwrap();
    let loops = [
        ("a = [[0, 1], [-10, 0]]", "a = [[0, 1], [-10]]", "row 2 has 1 numbers, row 1 has 2"),
        ("a = [[0, 1], [-10, 0]]", "a = [[0, 1]]", "`A` is 1 × 2; expected a square matrix"),
        (
            "a = [[0, 1], [-10, 0]]",
            "a = [[0, 1], [nan, 0]]",
            "row 2, column 1; expected a finite number",
        ),
        ("b = [[0], [1]]", "b = [[0]]", "`B` is 1 × 1; expected 2 rows"),
        ("b = [[0], [1]]", "", "`a` is given, so `b` is required"),
        ("b = [[0], [1]]", "b = [[0], [1]]\nstates = [\"q\"]", "1 names of states for 2 states"),
        ("gain = [[10, 2]]", "gain = [[10]]", "`gain` is 1 × 1; expected 1 × 2"),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.state-space]\nmeasures = \"state\"\nd = [[-10, -2]]",
            "unknown value `state` of `measures`",
        ),
        ("period = 0.01", "period = 0", "`period` is 0.0; expected a finite number above 0"),
        (
            "period = 0.01",
            "period = 0.01\nlatency = [0, 1]",
            "`latency` has 2 values; expected one",
        ),
        ("period = 0.01", "period = 0.01\nloss = 1", "`loss` is 1.0; expected a probability"),
        ("period = 0.01", "period = 0.01\nlatensy = 1", "unknown key `latensy`"),
        ("period = 0.01", "period = 0.01\nlatency = 10", "states with all commands"),
        ("[controller.state-feedback]\ngain = [[10, 2]]", "", "there is no controller"),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.lqr]\nstates = [1, 1]\ninputs = [0]",
            "`input weights` has the eigenvalue",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\ninput = \"u2\"\nlag = 1\n[controller.state-feedback]",
            "unknown input `u2`",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\ninput = \"u1\"\ndifference = true\n[controller.state-feedback]",
            "`difference` stands before the input `u1`; expected an output",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\noutput = \"x1\"\nmoving-average = 0\n[controller.state-feedback]",
            "averages 0 samples; expected 1 to 100",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\noutput = \"x1\"\nmoving-average = 2\nlag = 1\n[controller.state-feedback]",
            "exactly one of `lag`, `butterworth2`, `moving-average` and `difference = true`",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 2\ninner = { gain = [[1]] }\nouter = { gain = [[1, 0]] }",
            "`gain` is 1 × 1; expected 1 × 3: inputs × outputs and references",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 101\ninner = { gain = [[1, 1, 1]] }\nouter = { gain = [[1, 0]] }",
            "`every` is 101; expected 1 to 100 periods",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 2\ninner = { gain = [[1, 1, 1]] }\nouter = { pid = [] }",
            "has no references",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 2\ninner = { gain = [[1, 1, 1]] }\nouter = { pid = [{ output = \"x1\", input = \"u1\", reference = \"r\", proportional = 1 }] }",
            "expected only a `reference`",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\ninput = \"u1\"\nlag = -1\n[controller.state-feedback]",
            "time constant of -1; expected a finite number above 0",
        ),
    ];
    for (from, to, wanted) in loops {
        let text = OSCILLATOR.replace(from, to);
        assert_ne!(text, OSCILLATOR, "{from}");
        let path = written(&folder, "wrong.toml", &text);
        libration(&["advise", "--config", path.to_str().unwrap()])
            .code(2)
            .stdout("")
            .stderr(predicate::str::contains(wanted));
    }
    let plant = written(&folder, "p.csv", "A, 0, one\n");
    let plant = plant.to_str().unwrap();
    let words = ["advise", "--plant", plant, "--lqr", "1/1"];
    libration(&words).code(2).stderr(predicate::str::contains("line 1: `one` is no number"));
    let oscillator = ["advise", "--system", "oscillator", "--feedback", "10,2"];
    for (rest, wanted) in [
        (&["--output-latency", "0.1"][..], "--output-latency is given, but the plant is a system"),
        (&["--redesign"], "--redesign is given, but the plant is a system"),
        (&["--plant", plant], "cannot be used with"),
    ] {
        libration(&[&oscillator, rest].concat()).code(2).stderr(predicate::str::contains(wanted));
    }
    libration(&["advise", "--plant", plant, "--horizon", "3"])
        .code(2)
        .stderr(predicate::str::contains("cannot be used with"));
    libration(&["advise", "--plant", plant])
        .code(2)
        .stderr(predicate::str::contains("`one` is no number"));
}

#[test]
fn motions_out_of_reach_and_motions_that_nothing_damps_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let text = "\
[system.linear]
a = [[0, 1, 0], [-10, 0, 0], [0, 0, 3]]
b = [[0], [1], [0]]
states = [\"swing\", \"rate\", \"runaway\"]
[controller.lqr]
states = [1, 1, 1]
inputs = [1]
";
    let path = written(&folder, "out.toml", text);
    libration(&["advise", "--config", path.to_str().unwrap()]).code(2).stderr(
        predicate::str::contains("no input reaches the mode of runaway (growth rate 3.0000 1/s)"),
    );
    let text = OSCILLATOR.replace("[[10, 2]]", "[[10, -2]]");
    let path = written(&folder, "grows.toml", &text);
    libration(&["advise", "--config", path.to_str().unwrap()]).code(1).stderr(
        predicate::str::contains("a motion grows by the factor")
            .and(predicate::str::contains("x2, x1")),
    );
}
