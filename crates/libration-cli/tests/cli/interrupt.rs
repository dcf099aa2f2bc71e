//! Ctrl-C: the run ends soon, and what it finished is kept.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

/// Waits until `done` holds; panics after half a minute.
pub(crate) fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < Duration::from_secs(30), "{what}: waited in vain");
        sleep(Duration::from_millis(10));
    }
}

pub(crate) fn interrupt(child: &Child) {
    signal(child, "INT");
}

/// Sends a signal of this name.
pub(crate) fn signal(child: &Child, name: &str) {
    let kill = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
}

#[test]
fn an_interrupted_run_leaves_valid_results() {
    let Some(study) = libration_lab::STUDIES.by_name("drift") else { return };
    let folder = tempfile::tempdir().unwrap();
    // Hours of work, in parts of a fraction of a second.
    let dt: Vec<String> = (1..=2000).map(|i| format!("{:?}", 1e-5 * f64::from(i))).collect();
    let config =
        format!("effort = 'quick'\n[drift]\nsteps = 10_000_000\ndt = [{}]\n", dt.join(", "));
    fs::write(folder.path().join("long.toml"), config).unwrap();
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("libration"))
        .args(["lab", "spectrum", study.name(), "--config", "long.toml", "--out", "out"])
        .current_dir(&folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let out = folder.path().join("out");
    wait_until("the first results", || out.join("libration-unfinished/results.json").is_file());
    interrupt(&child);
    wait_until("the end", || child.try_wait().unwrap().is_some());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("interrupted"), "{output:?}");
    let results: Value =
        serde_json::from_slice(&fs::read(out.join("results.json")).unwrap()).unwrap();
    assert_eq!(results["complete"], false);
    let studies = results["studies"].as_array().unwrap();
    assert_eq!(studies.iter().map(|study| &study["name"]).collect::<Vec<_>>(), ["spectrum"]);
}

#[test]
fn a_signal_ends_a_comparison_while_it_follows_the_motion() {
    // The reference alone takes minutes.
    let words = "analyze --system kepler --compare --tolerance 1e-12 --horizon 1e5";
    for (name, code) in [("INT", 130), ("TERM", 143)] {
        let mut child = Command::new(assert_cmd::cargo::cargo_bin("libration"))
            .args(words.split(' '))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        sleep(Duration::from_millis(500));
        signal(&child, name);
        let begin = Instant::now();
        wait_until("the end", || child.try_wait().unwrap().is_some());
        assert!(begin.elapsed() < Duration::from_secs(5), "{name}: {:?}", begin.elapsed());
        assert_eq!(child.wait().unwrap().code(), Some(code), "{name}");
    }
}

/// A chain of 60 lags with commands at both ends: the limits of its latencies take minutes, in searches that check no flag.
#[test]
fn a_signal_ends_advice_within_a_search_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let n = 60_usize;
    let entry = |i: usize, j: usize| if i == j { -2 } else { i32::from(i.abs_diff(j) == 1) };
    let row = |i: usize| (0..n).map(|j| entry(i, j).to_string()).collect::<Vec<_>>().join(", ");
    let a: Vec<String> = (0..n).map(|i| format!("[{}]", row(i))).collect();
    let b: Vec<String> =
        (0..n).map(|i| format!("[{}, {}]", u8::from(i == 0), u8::from(i == n - 1))).collect();
    let text = format!("a = [{}]\nb = [{}]\n", a.join(", "), b.join(", "));
    fs::write(folder.path().join("chain.toml"), text).unwrap();
    let weights = format!("{}/1,1", vec!["1"; n].join(","));
    let begin = |page: &str| {
        Command::new(assert_cmd::cargo::cargo_bin("libration"))
            .args(["advise", "--plant", "chain.toml", "--lqr", &weights, "--period", "0.1"])
            .args(["--latency", "0.05", "--jitter", "gaussian:0.1", "--page", page])
            .current_dir(&folder)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    };
    let runs = [("INT", 130, begin("a.html")), ("TERM", 143, begin("b.html"))];
    sleep(Duration::from_millis(700));
    let start = Instant::now();
    for (name, _, child) in &runs {
        signal(child, name);
    }
    for (name, code, child) in runs {
        let output = child.wait_with_output().unwrap();
        assert!(start.elapsed() < Duration::from_secs(5), "{name}: {:?}", start.elapsed());
        assert_eq!(output.status.code(), Some(code), "{name}: {output:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("interrupted"), "{output:?}");
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "a file is left");
}
