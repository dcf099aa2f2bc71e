//! `libration measure-jitter`, and what replays it, through the binary.

use std::fs;

use predicates::prelude::*;
use serde_json::Value;

use super::advise::{ADVISE, json, libration};

#[test]
fn a_clock_that_was_measured_can_be_replayed_and_advised_with() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("clock.csv");
    let path = file.to_str().unwrap();
    let measured = json(&[
        "measure-jitter",
        "-q",
        "--rate",
        "100",
        "--seconds",
        "2",
        "--priority",
        "ordinary",
        "--output",
        path,
    ]);
    let statistics = &measured[0]["statistics"];
    assert_eq!(statistics["intervals"], 199);
    // Whatever the machine did meanwhile, deadlines lie on a grid.
    let mean = statistics["mean"].as_f64().unwrap();
    assert!((mean / 1e-2 - 1.0).abs() < 0.5, "{mean}");
    let text = fs::read_to_string(&file).unwrap();
    assert_eq!(text.lines().nth(1), Some("time_ns"));
    assert_eq!(text.lines().count(), 202);
    let again = json(&["measure-jitter", "--from", path]);
    let [a, b] = [&again["jitter_rms"], &statistics["jitter_rms"]].map(|x| x.as_f64().unwrap());
    assert!((a - b).abs() < 1e-6, "{a} {b}");
    libration(&[
        "simulate",
        "--system",
        "oscillator",
        "--integrator",
        "velocity-verlet",
        "--dt",
        "0.01",
        "--steps",
        "199",
        "--save-every",
        "199",
        "--time-stamps",
        path,
    ])
    .success();
    let words = [&ADVISE[..], &["10,2", "--period", "0.01", "--jitter-file", path]].concat();
    let output = libration(&[&words[..], &["--json"]].concat()).get_output().clone();
    let advised: Value = serde_json::from_slice(&output.stdout).unwrap();
    // The mean of a busy machine may be that of another loop, of which nothing is known.
    let is_other = advised["verdict"]["outcome"] == "unknown";
    assert_eq!(is_other, (mean / 1e-2 - 1.0).abs() > 0.05, "{mean} {}", advised["answer"]);
    assert_eq!(output.status.code(), Some(i32::from(is_other)));
    let stated = advised["loop"]["budgets"][1]["stated"].as_f64().unwrap();
    assert!((stated - a).abs() < 1e-9, "{stated} {a}");
    // What only that record shows is asked again with it.
    for command in [&advised["repeat_command"], &advised["loop"]["combined"]["command"]] {
        assert!(command.as_str().unwrap().contains("--jitter-file"), "{command}");
    }
}

#[test]
fn clocks_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.csv");
    for (text, wanted) in [
        ("0\n1\n0.5\n", "time stamp 3"),
        ("time_ns\n5\n", "at least 2"),
        ("0\nfoo\n", "line 2 is `foo`"),
        ("0\n0\n", "mean step is 0"),
        ("0\nnan\n1\n", "line 2 is `nan`"),
    ] {
        fs::write(&file, text).unwrap();
        libration(&["measure-jitter", "--from", file.to_str().unwrap()])
            .code(2)
            .stderr(predicate::str::contains(wanted));
    }
    for (rest, wanted) in [
        (["--rate", "0"], "--rate is 0"),
        (["--rate", "nan"], "--rate is NaN"),
        (["--seconds", "0.001"], "--seconds is 0.001"),
        (["--priority", "highest"], "possible values"),
    ] {
        let words = [&["measure-jitter"][..], &rest].concat();
        libration(&words).code(2).stderr(predicate::str::contains(wanted));
    }
    // Repeats and gaps are told.
    fs::write(&file, "0\n1\n1\n2\n5\n").unwrap();
    libration(&["measure-jitter", "--from", file.to_str().unwrap()]).success().stdout(
        predicate::str::contains("repeated time stamps   1").and(predicate::str::contains("gaps")),
    );
}

#[test]
fn the_rounding_of_stamps_is_no_jitter() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("even.csv");
    let rows: Vec<String> = (0..1000).map(|n| (f64::from(n) / 3.0).to_string()).collect();
    fs::write(&file, format!("t\n{}\n", rows.join("\n"))).unwrap();
    let path = file.to_str().unwrap();
    let is_even = || {
        predicate::str::contains("intervals are equal up to the resolution")
            .and(predicate::str::contains("spectrum").not())
            .and(predicate::str::contains("correlation").not())
    };
    for words in [["clock", path].to_vec(), ["measure-jitter", "--from", path].to_vec()] {
        libration(&words).success().stdout(is_even());
    }
    let found = json(&["clock", path]);
    assert_eq!(found["clock"]["law"]["verdict"], "constant");
    // Rows without a time are counted.
    fs::write(&file, format!("t,x\n{}\n,2\n", rows.join(",1\n") + ",1")).unwrap();
    libration(&["clock", path]).success().stdout(
        predicate::str::contains("1 of 1001 rows have no time in `t`")
            .and(predicate::str::contains("1000 of 1001 messages")),
    );
}

#[test]
fn intervals_that_repeat_in_a_pattern_are_not_called_independent() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("clock.csv");
    // Long and short intervals in turn, and a short one after two of the mean: correlations of ±1 in both.
    for lengths in [&[5, 15][..], &[10, 10, 4]] {
        let mut at = 0;
        let stamps = (0..3000).map(|k| {
            at += lengths[k % lengths.len()];
            format!("{}.{:03}", at / 1000, at % 1000)
        });
        let stamps: Vec<String> = stamps.collect();
        fs::write(&file, format!("t\n{}\n", stamps.join("\n"))).unwrap();
        let found = libration(&["clock", file.to_str().unwrap()]);
        let text = String::from_utf8(found.get_output().stdout.clone()).unwrap();
        assert!(text.contains("intervals repeat in a pattern: replay the record"), "{text}");
        assert!(!text.contains("are independent") && !text.contains("--jitter gaussian"), "{text}");
    }
}
