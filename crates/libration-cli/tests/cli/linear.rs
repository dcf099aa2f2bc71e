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
        libration(&["advise", "-v", "--config", &example(name), "--page", page.to_str().unwrap()])
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
fn all_windows_of_a_latency_are_listed_and_several_channels_have_a_limit_together() {
    let folder = tempfile::tempdir().unwrap();
    let text = "\
[system.linear]
a = [[0, 1], [-400, -0.4]]
b = [[0], [1]]
c = [[0, 1]]
[controller.state-space]
d = [[-2]]
";
    let path = written(&folder, "windows.toml", text);
    let advice = json(&["advise", "--config", path.to_str().unwrap()]);
    let windows = advice["budgets"][0]["later_windows"].as_array().unwrap();
    let ends = |window: &Value| ["from", "to"].map(|end| window[end].as_f64().unwrap());
    // By eigenvalues of NumPy at every half millisecond up to 1.6 s: the first at which the answer changes.
    let scanned =
        [[0.232, 0.379], [0.562, 0.678], [0.892, 0.977], [1.222, 1.2765], [1.5515, 1.5755]];
    assert_eq!(windows.len(), scanned.len(), "{windows:?}");
    for (found, wanted) in windows.iter().map(ends).zip(scanned) {
        let before = |i: usize| (0.0..5e-4).contains(&(wanted[i] - found[i]));
        assert!(before(0) && before(1), "{found:?} {wanted:?}");
    }
    // Two equal axes without coupling: together they have the limit of each.
    let twins = "\
[system.linear]
a = [[0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]]
b = [[0, 0], [1, 0], [0, 0], [0, 1]]
[controller.state-feedback]
gain = [[9, 3, 0, 0], [0, 0, 9, 3]]
[loop]
latency = [0.02, 0.01]
";
    let path = written(&folder, "twins.toml", twins);
    let advice = json(&["advise", "--config", path.to_str().unwrap()]);
    let [all, one] = ["all inputs", "u1"].map(|name| limit(&advice, "latency", Some(name)));
    assert!((all.unwrap() - one.unwrap()).abs() < 1e-9, "{all:?} {one:?}");
    assert_eq!(advice["budgets"][0]["stated"], 0.01);
}

#[test]
fn an_unstable_loop_and_a_limit_of_probability_have_words_in_the_text() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{OSCILLATOR}latency = 2.0\n");
    let path = written(&folder, "late.toml", &text);
    libration(&["advise", "--verbose", "--config", path.to_str().unwrap()])
        .stdout(predicate::str::contains("cost under noise: infinite"))
        .stdout(predicate::str::is_match("(?m)^x1 .* infinite$").unwrap());
    // A plant that decays without commands is stable with all losses.
    let text = "[system.linear]\na = [[-1]]\nb = [[1]]\n[controller.state-feedback]\ngain = [[0.5]]\n[loop]\nperiod = 0.01\n";
    let path = written(&folder, "decaying.toml", text);
    libration(&["advise", "--config", path.to_str().unwrap()]).success().stdout(
        predicate::str::is_match("(?m)^lost commands .* any below 1 .* probability").unwrap(),
    );
}

#[test]
fn numbers_to_paste_stay_whole_in_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let bearing = example("magnetic_bearing.toml");
    let to = page.to_str().unwrap();
    libration(&["advise", "--config", &bearing, "--redesign", "--page", to]).success();
    let page = fs::read_to_string(page).unwrap();
    // Those of the live section are empty until a reader changes something.
    let codes: Vec<&str> = page
        .split("<pre ")
        .skip(1)
        .map(|code| code.split("</pre>").next().unwrap())
        .filter(|code| !code.contains("live-code"))
        .collect();
    let [redesign, gain] = &codes[..] else { panic!("{} codes", codes.len()) };
    assert!(redesign.contains("<span>[controller.state-space]</span>"), "{redesign}");
    // Each of the three numbers is in a span of its own, which does not break.
    assert_eq!(gain.matches("<span>").count(), 3, "{gain}");
}
