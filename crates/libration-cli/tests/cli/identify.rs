//! `identify`.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use predicates::prelude::*;
use serde_json::Value;

use super::advise::libration;

/// Uniform numbers from −1 to 1. Of numbers that repeat themselves no model is right.
fn draw(word: &mut u64) -> f64 {
    *word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*word >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Writes a log of a lag of 60 ms behind a dead time of 25 ms, in steps of 10 ms, with a small error.
fn log(folder: &std::path::Path) -> PathBuf {
    let (mut word, mut command, mut state) = (7, 0.0, 0.0_f64);
    let mut commands: Vec<f64> = Vec::new();
    let mut text = "t,cmd,q,still\n".to_owned();
    for i in 0..400 {
        if i % 5 == 0 {
            command = 0.5 * draw(&mut word);
        }
        let at = |back: usize| if i >= back { commands[i - back] } else { 0.0 };
        // The command of three periods ago acts up to the middle of the interval, that of two and a half after it.
        for late in [at(4), at(3)] {
            state = late + (state - late) * (-0.005_f64 / 0.06).exp();
        }
        commands.push(command);
        let error = 0.004 * draw(&mut word);
        let _ = writeln!(text, "{},{command},{},1", f64::from(i as u32) * 0.01, state + error);
    }
    let path = folder.join("log.csv");
    fs::write(&path, text).unwrap();
    path
}

fn identify(more: &[&str]) -> assert_cmd::assert::Assert {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path());
    libration(&[&["identify", path.to_str().unwrap(), "-q"], more].concat())
}

const SIGNALS: [&str; 4] = ["--command", "cmd", "--response", "q"];

#[test]
fn a_log_is_identified_and_its_loop_is_advised() {
    let folder = tempfile::tempdir().unwrap();
    let log = log(folder.path());
    let [page, saved] = ["loop.html", "loop.toml"].map(|name| folder.path().join(name));
    let words = [
        "identify",
        log.to_str().unwrap(),
        "-q",
        "--bootstrap",
        "0",
        "--model",
        "lag",
        "--page",
        page.to_str().unwrap(),
        "--save-loop",
        saved.to_str().unwrap(),
        "--json",
    ];
    let done = libration(&[&words[..], &SIGNALS].concat()).success();
    let found: Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    let parameter = |key: &str| {
        let rows = found["parameters"].as_array().unwrap();
        rows.iter().find(|row| row["key"] == key).unwrap()["value"].as_f64().unwrap()
    };
    // The errors have a standard deviation of 2.3 mV/V, and steps of a quarter in the mean: 0.2 ms would be four standard errors.
    assert!((parameter("dead_time") - 0.025).abs() < 3e-4, "{}", parameter("dead_time"));
    assert!((parameter("lag") - 0.06).abs() < 2e-3, "{}", parameter("lag"));
    assert!(fs::read_to_string(&page).unwrap().contains("What are the parameters?"));
    libration(&["advise", "--config", saved.to_str().unwrap(), "-q"])
        .success()
        .stdout(predicate::str::contains("The loop is stable"));
}

#[test]
fn wrong_signals_and_numbers_are_errors_of_usage() {
    for (more, message) in [
        (["--command", "cnd", "--response", "q"], "cnd"),
        (["--command", "cmd", "--response", "still"], "the response is 1 throughout"),
    ] {
        identify(&more).code(2).stderr(predicate::str::contains(message));
    }
    for (more, message) in [
        (["--model", "lagg"], "expected auto, delay, lag"),
        (["--dead-time", "-1"], "--dead-time is -1; expected a number of at least 0 s"),
        (["--gain", "0"], "--gain is 0; expected a number other than 0"),
        (["--largest-dead-time", "9"], "lower the largest dead time"),
        (["--bootstrap", "1000000"], "--bootstrap is 1000000; expected at most 10000"),
        (["--page", "/nowhere/loop.html"], "--page"),
        (["--plant", "/nowhere/plant.toml"], "--plant"),
    ] {
        identify(&[&SIGNALS[..], &more].concat()).code(2).stderr(predicate::str::contains(message));
    }
}

/// Writes a step test of a lag of 50 ms behind a dead time of 30 ms: 2 s at 100 Hz, with a small error.
fn step_test(folder: &std::path::Path, step: f64) -> String {
    let mut text = "t,cmd,q\n".to_owned();
    let mut word = 11;
    for i in 0..200_u32 {
        let time = 0.01 * f64::from(i);
        let since = (time - step - 0.03).max(0.0);
        let error = 0.002 * draw(&mut word);
        let command = u8::from(time > step - 1e-9);
        let _ = writeln!(text, "{time},{command},{}", 1.0 - (-since / 0.05).exp() + error);
    }
    let path = folder.join("step.csv");
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_step_test_is_identified_wherever_its_step_is_and_the_verdict_decides_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let identify = |step: f64, more: &[&str]| {
        let log = step_test(folder.path(), step);
        let lag = ["--model", "lag", "--noise", "white", "--bootstrap", "0", "-q"];
        libration(&[&["identify", &log][..], &SIGNALS, &lag, more].concat())
    };
    let read = |step: f64, more: &[&str]| {
        let done = identify(step, &[&["--json"], more].concat()).success();
        let found: Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
        assert_eq!(
            (&found["start"], &found["verdict"]["outcome"]),
            (&"rest".into(), &"no-fault".into())
        );
        let rows = found["parameters"].as_array().unwrap();
        let value = |key: &str| {
            rows.iter().find(|row| row["key"] == key).unwrap()["value"].as_f64().unwrap()
        };
        // An error of 1.2e-3 rms beside slopes of 20/s: of a few responses on the slope 0.1 ms in the mean.
        assert!((value("dead_time") - 0.03).abs() < 1e-3, "{}", found["answer"]);
        assert!((value("lag") - 0.05).abs() < 2e-3, "{}", found["answer"]);
    };
    read(0.1, &[]);
    read(0.0, &["--command-before", "0"]);
    let help = "the command is 1 throughout; expected a command that changes, since nothing else shows a latency; \
        help: if another command acted before the recording, state it with --command-before";
    identify(0.0, &[]).code(2).stderr(predicate::str::contains(help));
    // Without the responses up to the largest dead time nothing is left of the step: no numbers, no loop, exit code 1.
    let saved = folder.path().join("loop.toml");
    let words = ["--start", "unknown", "--save-loop", saved.to_str().unwrap()];
    identify(0.1, &words)
        .code(1)
        .stdout(
            predicate::str::contains("verdict: unknown: 0 of 1 changes of the command")
                .and(predicate::str::contains("estimate").not()),
        )
        .stderr(predicate::str::contains("(--save-loop) is not written"));
    assert!(!saved.exists());
    let wrong = "--budget is 5; expected 100 to 1000000000 evaluations";
    identify(0.1, &["--budget", "5"]).code(2).stderr(predicate::str::contains(wrong));
}
