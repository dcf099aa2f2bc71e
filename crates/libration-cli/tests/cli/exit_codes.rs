//! Exit codes: 0 success, 1 failed run or measurement outside its tolerance, 2 invalid input, 130 interrupted.

use std::fs;
use std::path::Path;
use std::process::{Child, Command as Process, Stdio};
use std::thread::sleep;
use std::time::Duration;

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::{contains, is_empty};

use crate::interrupt::{interrupt, wait_until};

const ANALYZE: &str = "analyze --system oscillator --integrator rk4 --dt 0.01";

/// Commands that print at once, one for each way in which they do.
const PRINTING: [&str; 12] = [
    "--help",
    "lab --help",
    "--version",
    "lab --print-config",
    "lab --schema",
    "advise --print-config",
    "rollout --print-config",
    ANALYZE,
    "list",
    "list --json",
    "completions zsh",
    "simulate --system oscillator --integrator rk4 --dt 0.1 --steps 3 --format npy",
];

fn libration(folder: &Path, words: &str) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.current_dir(folder).args(words.split_whitespace());
    command
}

fn start(folder: &Path, words: &str, stdout: impl Into<Stdio>) -> Child {
    Process::new(assert_cmd::cargo::cargo_bin("libration"))
        .current_dir(folder)
        .args(words.split_whitespace())
        .stdout(stdout)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_a_failed_run_of_every_command() {
    let folder = tempfile::tempdir().unwrap();
    for words in PRINTING {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = start(folder.path(), words, full).wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{words}: {output:?}");
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(told.contains("cannot write to standard output"), "{words}: {told}");
    }
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error_of_any_command() {
    let folder = tempfile::tempdir().unwrap();
    for words in PRINTING {
        let mut child = start(folder.path(), words, Stdio::piped());
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{words}: {output:?}");
        assert!(output.stderr.is_empty(), "{words}: {output:?}");
    }
}

#[test]
fn a_report_that_no_program_can_show_is_a_warning_and_no_failed_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut lab = libration(folder.path(), "--quiet lab spectrum --effort quick --open");
    // No program is found.
    let run = lab.env("PATH", folder.path()).assert().code(0).stdout(is_empty());
    run.stderr(contains("warning: cannot show").and(contains("--open")));
    assert!(folder.path().join("libration-report/report.html").is_file());
}

#[test]
fn a_folder_that_cannot_be_used_is_wrong_input() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    for (words, told) in [
        ("lab spectrum --out file", "file"),
        ("rollout --transitions 1000 --out file", "file"),
        ("rollout --transitions 1000 --out file/in", "file/in"),
        ("verify file", "file/manifest.jsonl"),
        ("verify nowhere", "nowhere"),
        ("bench --storage --folder file", "file"),
        #[cfg(target_os = "linux")]
        ("rollout --transitions 1000 --out /proc/data", "/proc/data"),
        #[cfg(target_os = "linux")]
        ("bench --storage --folder /proc", "/proc"),
    ] {
        libration(folder.path(), words)
            .assert()
            .code(2)
            .stdout(is_empty())
            .stderr(contains(told).and(contains("error: ")));
    }
}

#[cfg(unix)]
#[test]
fn every_command_that_is_interrupted_says_so_by_its_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    // Reading it waits for somebody who writes.
    let made = Process::new("mkfifo").arg(folder.path().join("pipe")).status();
    assert!(made.unwrap().success());
    for words in [
        "analyze --system pendulum --integrator rk4 --dt 0.01 --steps 1e9",
        "lab --config pipe",
        "advise --config pipe",
        "rollout --out out --config pipe",
        "measure-jitter --from pipe",
        "measure-jitter --rate 100 --seconds 60",
        "simulate --system pendulum --integrator rk4 --dt 0.01 --steps 1e9 --save-every 1e9",
    ] {
        let mut child = start(folder.path(), words, Stdio::null());
        // Long enough to have begun; a process that still starts is interrupted as well.
        sleep(Duration::from_millis(500));
        assert!(child.try_wait().unwrap().is_none(), "{words} ended early");
        interrupt(&child);
        wait_until(words, || child.try_wait().unwrap().is_some());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{words}: {output:?}");
    }
}
