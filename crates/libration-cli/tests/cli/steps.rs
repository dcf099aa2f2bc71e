//! Many steps of `simulate`, and how far they are.

use std::io::Read;
use std::process::{Command as Process, Stdio};

use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
#[cfg(target_os = "linux")]
use predicates::str::is_empty;
use serde_json::Value;
#[cfg(target_os = "linux")]
use tempfile::TempDir;

use crate::simulate::{folder, libration};

#[test]
fn a_run_may_have_more_steps_than_anybody_waits_for() {
    let folder = folder();
    // It overflows long before.
    let words = "simulate --system oscillator --integrator explicit-euler --dt 0.1 --format json \
                 --steps 9007199254740992 --save-every 1e14";
    let overflow = libration(&folder, words).assert().code(1);
    let json: Value = serde_json::from_slice(&overflow.get_output().stdout).unwrap();
    assert_eq!(json["steps"], 1_u64 << 53);
    assert_eq!(json["rows"].as_array().unwrap().len(), 2);
    let words = words.replace("9007199254740992", "9007199254740993");
    let refused = libration(&folder, &words).assert().code(2);
    refused.stderr(contains("9007199254740993").and(contains("1 to 9007199254740992")));
}

/// Runs the program on a terminal of its own; gives the exit code and what it showed.
#[cfg(target_os = "linux")]
fn on_a_terminal(folder: &TempDir, words: &str) -> (Option<i32>, String) {
    let program = assert_cmd::cargo::cargo_bin("libration");
    let line = format!("{} {words}", program.display());
    let shown = Process::new("script")
        .args(["--quiet", "--return", "--command", &line, "/dev/null"])
        .env("TERM", "xterm")
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    (shown.status.code(), String::from_utf8_lossy(&shown.stdout).into_owned())
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_shows_how_many_steps_are_taken_and_the_time_left() {
    let folder = folder();
    let words = "simulate --system kepler --integrator rk4 --dt 1e-3 --steps 1e5 --save-every 1e6 \
                 --output x.csv";
    // More than a second of work, of which a bar is drawn every 0.2 s.
    let (code, shown) = on_a_terminal(&folder, &words.replace("1e5", "3e7"));
    assert_eq!(code, Some(0), "{shown}");
    assert!(shown.contains("of 30,000,000 steps") && shown.contains(" left"), "{shown}");
    let (code, shown) = on_a_terminal(&folder, &format!("--quiet {words}"));
    assert_eq!((code, &*shown), (Some(0), ""));
    // Rows on the terminal are not mixed with a bar.
    let (code, shown) = on_a_terminal(&folder, &words.replace("--output x.csv", ""));
    assert!(code == Some(0) && !shown.contains("left"), "{shown}");
    libration(&folder, words).assert().success().stdout(is_empty()).stderr(is_empty());
}

#[test]
fn rows_of_csv_and_json_are_streamed_however_many_there_are() {
    for (format, count) in [("csv", ""), ("json", ""), ("csv", "--num-trajectories 100")] {
        let words = format!(
            "simulate --system oscillator --integrator rk4 --dt 0.01 --steps 1e15 {count} --format {format}"
        );
        let mut child = Process::new(assert_cmd::cargo::cargo_bin("libration"))
            .args(words.split_whitespace())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut first = [0; 100];
        child.stdout.take().unwrap().read_exact(&mut first).unwrap();
        // Its reader is gone.
        assert!(child.wait().unwrap().success(), "{words}");
    }
}
