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
