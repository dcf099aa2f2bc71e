//! `libration advise` and the cost in `libration analyze`, through the binary.

use std::fs;

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use predicates::prelude::*;
use serde_json::Value;

pub(crate) fn libration(words: &[&str]) -> Assert {
    Command::cargo_bin("libration").unwrap().args(words).assert()
}

pub(crate) fn json(words: &[&str]) -> Value {
    let output = libration(&[words, &["--json"]].concat()).success().get_output().stdout.clone();
    serde_json::from_slice(&output).unwrap()
}

const LOOP: [&str; 7] =
    ["analyze", "--system", "oscillator", "--set", "omega2=10", "--feedback", "10,2"];

#[test]
fn the_cost_of_an_exact_loop_is_that_of_the_reference() {
    let of = |rest: &[&str]| json(&[&LOOP[..], &["--integrator", "exact"], rest].concat());
    let ideal = of(&["--dt", "0.01"]);
    let close = |x: &Value, wanted: f64, off: f64| {
        let x = x.as_f64().unwrap();
        assert!((x - wanted).abs() < off, "{x} {wanted}");
    };
    close(&ideal["cost"], 0.193623221394, 1e-12);
    close(&ideal["cost_increase"], 0.0, 1e-15);
    assert_eq!(ideal["cost_weights"], serde_json::json!([5.0, 0.5, 0.0]));
    close(&of(&["--dt", "0.1"])["cost"], 0.271766741205, 1e-12);
    close(&of(&["--dt", "0.01", "--latency", "1steps"])["cost_increase"], 0.069875502, 1e-9);
    let lost = of(&[
        "--dt",
        "0.01",
        "--loss",
        "0.5",
        "--jitter",
        "gaussian:0.1",
        "--skew",
        "gaussian:0.01",
    ]);
    assert!(lost["cost"].as_f64().unwrap() > 0.195, "{}", lost["cost"]);
    let words =
        [&LOOP[..], &["--integrator", "exact", "--dt", "0.01", "--latency", "0.2"]].concat();
    let unstable = libration(&[&words[..], &["--json"]].concat()).code(1);
    let unstable: Value = serde_json::from_slice(&unstable.get_output().stdout).unwrap();
    assert_eq!(unstable["verdicts"]["loop"]["outcome"], "unstable");
    assert_eq!(unstable["cost"], Value::Null);
    assert_eq!(unstable["cost_infinite"], Value::Bool(true));
    libration(&words).code(1).stdout(predicate::str::contains("infinite: second moments grow"));
}

#[test]
fn costs_that_cannot_be_asked_are_usage_errors() {
    let method = ["--integrator", "rk4", "--dt", "0.01"];
    for (rest, wanted) in [
        (&["--loss", "1"][..], "at least 0 and below 1"),
        (&["--loss", "-0.1"], "at least 0 and below 1"),
        (&["--cost-weights", "1,2"], "three numbers"),
        (&["--cost-weights", "1,-2,0"], "three numbers"),
    ] {
        libration(&[&LOOP[..], &method, rest].concat())
            .code(2)
            .stderr(predicate::str::contains(wanted));
    }
    let alone = [
        "analyze",
        "--system",
        "oscillator",
        "--integrator",
        "rk4",
        "--dt",
        "0.01",
        "--loss",
        "0.1",
    ];
    libration(&alone).code(2).stderr(predicate::str::contains("--feedback"));
}

pub(crate) const ADVISE: [&str; 9] = [
    "advise",
    "--quiet",
    "--system",
    "oscillator",
    "--set",
    "omega2=10",
    "--horizon",
    "2",
    "--feedback",
];

#[test]
fn advice_is_given_from_flags_and_its_command_shows_the_limit() {
    let words = [&ADVISE[..], &["10,2", "--period", "0.02", "--latency", "0.02"]].concat();
    libration(&words)
        .success()
        .stdout(predicate::str::starts_with("The loop is stable with the stated imperfections"));
    let found = json(&words);
    let latency = &found["loop"]["budgets"][0];
    let command = latency["command"].as_str().unwrap();
    let mut again: Vec<&str> = command.split(' ').collect();
    assert_eq!(again.remove(0), "libration");
    let radius = json(&again)["closed_loop_spectral_radius"].as_f64().unwrap();
    // The limit has the digits of a float, and the radius changes by less than a tenth in a period.
    assert!((radius - 1.0).abs() < 1e-9, "{radius} by {command}");
    assert_eq!(found["loop"]["fails_first"]["kind"], "latency");
}

#[test]
fn commands_say_again_what_was_said_of_all_together() {
    let rest = [
        "10,2",
        "--period",
        "0.02",
        "--latency",
        "1.5steps",
        "--jitter",
        "gaussian:0.1",
        "--skew",
        "0.01",
        "--loss",
        "0.05",
        "--cost-weights",
        "5,0.5,0.1",
    ];
    let words = [&ADVISE[..], &rest].concat();
    let found = json(&words);
    let combined = &found["loop"]["combined"];
    let command = combined["command"].as_str().unwrap();
    let again: Vec<&str> = command.split(' ').skip(1).collect();
    let shown = json(&again);
    let [said, shown] = [&combined["cost"], &shown["cost"]].map(|x| x.as_f64().unwrap());
    assert!((said / shown - 1.0).abs() < 1e-10, "{said} {shown} by {command}");
    assert_eq!(found["repeat_command"].as_str().unwrap(), format!("libration {}", words.join(" ")));
}

#[test]
fn a_command_names_files_as_a_shell_takes_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my loop.toml");
    fs::write(&file, "[start]\nq = [1.0]\n[request]\nhorizon = 1.0\n").unwrap();
    let path = file.to_str().unwrap();
    let found = json(&[
        "advise",
        "-q",
        "--config",
        path,
        "--page",
        folder.path().join("p.html").to_str().unwrap(),
    ]);
    assert_eq!(
        found["repeat_command"].as_str().unwrap(),
        format!("libration advise -q --config '{path}'")
    );
    // Flags say what else is wrong with a loop than the file does; without a loop they cannot.
    libration(&["advise", "-q", "--config", path, "--loss", "0.1"])
        .code(2)
        .stderr(predicate::str::contains("--loss is given, but there is no loop"));
    fs::write(
        &file,
        "[request]\nhorizon = 1.0\n[controller.observer]\ngains = [10, 2]\ncorrection = [0.1, 1]\n",
    )
    .unwrap();
    let found = json(&["advise", "-q", "--config", path]);
    let latency = &found["loop"]["budgets"][0];
    let command = latency["command"].as_str().unwrap();
    let (_, flags) = command.split_once("--latency").unwrap();
    let at: Vec<&str> = flags.split_whitespace().collect();
    // At the limit, where the last digit decides whether it stands.
    let shown = libration(&[&["advise", "-q", "--config", path, "--latency"], &at[..]].concat());
    let there: Value = serde_json::from_slice(&shown.get_output().stdout).unwrap();
    let growth = there["loop"]["combined"]["growth"].as_f64().unwrap();
    assert!(growth.abs() < 1e-6, "{growth} by {command}");
}

#[test]
fn a_loop_that_does_not_stand_what_is_stated_ends_with_1_and_an_unstable_one_says_how() {
    let late = [&ADVISE[..], &["10,2", "--period", "0.02", "--latency", "0.2"]].concat();
    libration(&late)
        .code(1)
        .stdout(predicate::str::contains("unstable with the stated imperfections"));
    let unstable = [&ADVISE[..], &["10,-2", "--period", "0.02"]].concat();
    libration(&unstable).code(1).stdout(
        predicate::str::contains("unstable without")
            .and(predicate::str::contains("it oscillates at")),
    );
}

#[test]
fn what_cannot_be_advised_on_is_a_usage_error_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let page = page.to_str().unwrap();
    for (rest, wanted) in [
        (&["10,2", "--period", "0"][..], "--period is 0"),
        (&["10,2", "--latency", "-1"], "a finite number of at least 0"),
        (&["10,2", "--cost-weights", "0,0,0"], "above 0 for one of the three"),
        (&["10,2", "--loss", "2"], "--loss is 2"),
        (&["10,2", "--tolerance", "energy=1e-3"], "a loop does not conserve it"),
        (&["10,2", "--tolerance", "speed=1"], "expected energy, phase, trajectory or cost"),
        (&["10,2", "--jitter-file", "none.csv"], "none.csv"),
    ] {
        let words = [&ADVISE[..], rest, &["--page", page]].concat();
        libration(&words).code(2).stderr(predicate::str::contains(wanted));
    }
    libration(&["advise"]).code(2).stderr(predicate::str::contains("--system"));
    libration(&["advise", "--config", "a.toml", "--period", "1"]).code(2);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_file_that_is_printed_is_a_file_that_can_be_asked() {
    let folder = tempfile::tempdir().unwrap();
    let (config, page) = (folder.path().join("mine.toml"), folder.path().join("page.html"));
    let printed = libration(&["advise", "--print-config"]).success().get_output().stdout.clone();
    fs::write(&config, printed).unwrap();
    let [config, page] = [&config, &page].map(|path| path.to_str().unwrap());
    libration(&["advise", "-q", "--config", config, "--page", page]).success();
    let text = fs::read_to_string(page).unwrap();
    assert!(text.contains("The loop is stable") && text.contains("<svg"));
    fs::write(config, "[loop]\nlatency = \"late\"\n").unwrap();
    libration(&["advise", "--config", config]).code(2).stderr(
        predicate::str::contains("loop.latency").and(predicate::str::contains("mine.toml")),
    );
}
