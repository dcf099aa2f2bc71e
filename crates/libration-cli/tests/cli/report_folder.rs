//! The folder of a report: what a run leaves of an earlier one, whether it ends, is interrupted or is killed.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command as Process, Stdio};

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::Value;
use tempfile::TempDir;

use crate::interrupt::{interrupt, signal, wait_until};

/// Hours of work in parts of a fraction of a second, after a study of a moment.
const LONG: [&str; 4] = ["spectrum", "drift", "--config", "long.toml"];

/// A folder with the configuration of [`LONG`].
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let dt: Vec<String> = (1..=2000).map(|i| format!("{:?}", 1e-5 * f64::from(i))).collect();
    let config =
        format!("effort = 'quick'\n[drift]\nsteps = 10_000_000\ndt = [{}]\n", dt.join(", "));
    fs::write(folder.path().join("long.toml"), config).unwrap();
    folder
}

/// Runs studies that take a moment into `out`.
fn report(folder: &TempDir, studies: &[&str]) {
    lab(folder, studies).assert().success();
}

fn lab(folder: &TempDir, studies: &[&str]) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.current_dir(folder).args(["--quiet", "lab", "--effort", "quick", "--out", "out"]);
    command.args(studies);
    command
}

/// Starts studies into `out`; waits until the last of them is under way.
fn start(folder: &TempDir, words: &[&str], last: &str) -> Child {
    let mut child = Process::new(assert_cmd::cargo::cargo_bin("libration"))
        .args(["lab", "--out", "out"])
        .args(words)
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.trim_end().ends_with(last) {
        line.clear();
        assert!(told.read_line(&mut line).unwrap() > 0, "the run ended before `{last}`");
    }
    child.stderr = Some(told.into_inner());
    child
}

/// Interrupts a run; gives what it said last.
fn interrupted(child: Child) -> String {
    interrupt(&child);
    last_words(child, 130)
}

/// Terminates a run; gives what it said last.
fn terminated(child: Child) -> String {
    signal(&child, "TERM");
    last_words(child, 143)
}

fn last_words(mut child: Child, code: i32) -> String {
    wait_until("the end", || child.try_wait().unwrap().is_some());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(code), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// All files of a folder but the one that is locked and those of an unfinished run, with their bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut found, mut folders) = (BTreeMap::new(), vec![folder.to_owned()]);
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(&inner).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && name != "libration-unfinished" {
                folders.push(path);
            } else if path.is_file() && name != ".libration-lock" {
                let bytes = fs::read(&path).unwrap();
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), bytes);
            }
        }
    }
    found
}

fn results(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("results.json")).unwrap()).unwrap()
}

#[test]
fn a_run_that_is_interrupted_keeps_the_older_report() {
    let folder = folder();
    let out = folder.path().join("out");
    report(&folder, &["spectrum"]);
    let older = files(&out);
    assert!(older.len() > 4, "{:?}", older.keys());
    let told = interrupted(start(&folder, &LONG[1..], "drift"));
    assert!(told.contains("no study had ended"), "{told}");
    assert!(files(&out) == older);
    assert!(!out.join("libration-unfinished").exists());
}

#[test]
fn an_interrupted_run_keeps_what_it_finished_beside_the_older_report_and_says_where() {
    let folder = folder();
    let out = folder.path().join("out");
    report(&folder, &["spectrum"]);
    let older = files(&out);
    let told = interrupted(start(&folder, &LONG, "drift"));
    assert!(told.contains("`out/libration-unfinished`"), "{told}");
    assert!(files(&out) == older);
    let aside = out.join("libration-unfinished");
    let partial = results(&aside);
    assert_eq!(partial["complete"], false);
    assert_eq!(partial["studies"][0]["name"], "spectrum");
    assert!(fs::read_to_string(aside.join("report.html")).unwrap().contains("incomplete"));
    // A run that finishes nothing leaves it, and one that finishes all removes it.
    interrupted(start(&folder, &LONG[1..], "drift"));
    assert_eq!(results(&aside), partial);
    report(&folder, &["spectrum"]);
    assert!(!aside.exists());
}

#[test]
fn an_interrupted_run_replaces_an_older_one_that_finished_no_more() {
    let folder = folder();
    let out = folder.path().join("out");
    // A termination keeps what ended as Ctrl-C does.
    for end in [interrupted, terminated] {
        let told = end(start(&folder, &LONG, "drift"));
        assert!(told.contains("`out` holds the studies that ended"), "{told}");
        let results = results(&out);
        assert_eq!(results["complete"], false);
        assert_eq!(results["studies"].as_array().unwrap().len(), 1);
        assert!(!out.join("libration-unfinished").exists());
    }
    report(&folder, &["spectrum"]);
    assert_eq!(results(&out)["complete"], true);
}

#[test]
fn a_run_into_the_folder_of_another_is_refused() {
    let folder = folder();
    let first = start(&folder, &LONG, "drift");
    let second = lab(&folder, &["spectrum"]).assert().code(2);
    second.stderr(contains("`out`").and(contains("another run writes there")));
    interrupted(first);
    report(&folder, &["spectrum"]);
}

#[test]
fn a_smaller_run_leaves_nothing_of_a_larger_one_and_all_that_is_the_users() {
    let folder = folder();
    let out = folder.path().join("out");
    report(&folder, &["spectrum"]);
    let small: Vec<PathBuf> = files(&out).into_keys().collect();
    report(&folder, &["spectrum", "error"]);
    assert!(files(&out).len() > small.len() + 2);
    let own = ["notes.txt", "figures/error-mine.svg", "data/error-mine.parquet"].map(PathBuf::from);
    own.iter().for_each(|name| fs::write(out.join(name), "mine").unwrap());
    report(&folder, &["spectrum"]);
    let mut wanted = [&small[..], &own].concat();
    wanted.sort();
    assert_eq!(files(&out).into_keys().collect::<Vec<_>>(), wanted);
}

#[test]
fn a_killed_run_blocks_no_other_and_loses_no_report() {
    let folder = folder();
    let out = folder.path().join("out");
    report(&folder, &["spectrum"]);
    let older = files(&out);
    let mut child = start(&folder, &LONG, "drift");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(files(&out) == older);
    assert_eq!(results(&out.join("libration-unfinished"))["studies"][0]["name"], "spectrum");
    report(&folder, &["spectrum"]);
    assert!(!out.join("libration-unfinished").exists());
}
