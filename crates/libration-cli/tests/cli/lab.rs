//! What the command prints, where, and its exit code.

use std::fs;
use std::path::Path;
use std::process::Command as Process;
use std::process::Stdio;

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::TempDir;

/// An empty folder to work in.
fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// The command in `folder`, without a terminal.
fn libration(folder: &TempDir) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.current_dir(folder).env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
    command
}

/// Wrong input: exit code 2, nothing on stdout, `parts` on stderr, and no report.
fn assert_wrong(folder: &TempDir, words: &[&str], parts: &[&str]) -> Assert {
    let before = entries(folder.path());
    let mut assert = libration(folder).args(words).assert().code(2).stdout("");
    for part in parts {
        assert = assert.stderr(contains(*part));
    }
    assert_eq!(entries(folder.path()), before, "{words:?} left something behind");
    assert
}

fn entries(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

#[test]
fn help_and_version_go_to_stdout() {
    let folder = folder();
    let help = libration(&folder).arg("--help").assert().success().stderr("");
    help.stdout(contains("libration lab --print-config > mine.toml").and(contains("Exit codes")));
    let version = format!("libration {}\n", env!("CARGO_PKG_VERSION"));
    libration(&folder).arg("--version").assert().success().stdout(version);
    for command in ["lab", "list", "completions"] {
        libration(&folder).args([command, "--help"]).assert().success().stdout(contains("Usage:"));
    }
}

#[test]
fn wrong_flags_are_named_with_what_is_allowed() {
    let folder = folder();
    let cases: &[(&[&str], &[&str])] = &[
        (&[], &["Usage:"]),
        (&["lists"], &["'lists'", "'list'"]),
        (&["lab", "--effrt", "quick"], &["'--effrt'", "'--effort'"]),
        (&["lab", "--effort", "quik"], &["'quik'", "--effort", "quick, standard, thorough"]),
        (&["lab", "--color", "red"], &["'red'", "--color", "auto, always, never"]),
        (&["lab", "--out"], &["--out"]),
        (&["lab", "--out", ""], &["--out"]),
        (&["lab", "--config", ""], &["--config"]),
        (&["lab", "no-such-study"], &["'no-such-study'", "STUDY"]),
        (&["lab", "--schema", "--open"], &["--schema", "--open"]),
        (&["completions", "tcsh"], &["'tcsh'", "bash"]),
        (&["list", "studies"], &["'studies'"]),
    ];
    for (words, parts) in cases {
        assert_wrong(&folder, words, parts);
    }
}

#[test]
fn a_study_that_is_nearly_right_is_guessed() {
    let folder = folder();
    for study in libration_lab::STUDIES.studies {
        let nearly = format!("{}x", study.name());
        assert_wrong(&folder, &["lab", &nearly], &[&format!("'{}'", study.name())]);
    }
}

#[test]
fn wrong_configurations_are_shown_at_the_place() {
    let folder = folder();
    let cases: &[(&[u8], &[&str])] = &[
        (b"[system.oscillator]\nk = 0\n", &["mine.toml:2:5", "`system.oscillator.k` is 0.0"]),
        (b"[system.oscillator]\nm = -1\nk = 1\n", &["mine.toml:2:5", "`m` is -1.0"]),
        (b"[system.oscillator]\nm = 'one'\n", &["mine.toml:2:5", "expected a number", "^^^^^"]),
        (b"[oscillator]\n", &["mine.toml:1:2", "unknown key `oscillator`", "[system.oscillator]"]),
        (b"[system.pendulum]\n", &["mine.toml:1:9", "libration lab --system FILE"]),
        (b"[drift]\ndt = [0.1, 0]\n", &["mine.toml:2:12", "`drift.dt` is 0.0"]),
        (b"[drift]\ndt = [nan]\n", &["mine.toml:2:7", "`drift.dt` is NaN"]),
        (b"[drift]\nsteps = 0\n", &["mine.toml:2:9", "`drift.steps` is 0", "1 to"]),
        (b"[start]\nq = [1, 2]\n", &["mine.toml:2:5", "`start.q` has 2 numbers", "expected one"]),
        (b"integrators = ['rk5']\n", &["mine.toml:1:16", "`rk5`", "`rk4`?", "`leapfrog`"]),
        (b"studies = ['no-such']\n", &["mine.toml:1:12", "unknown study `no-such`"]),
        (b"effort = \n", &["mine.toml:1:10", "error: "]),
        (b"\xFF\n", &["mine.toml:1:1", "not UTF-8"]),
    ];
    for (text, parts) in cases {
        fs::write(folder.path().join("mine.toml"), text).unwrap();
        assert_wrong(&folder, &["lab", "--config", "mine.toml"], parts);
        assert_wrong(&folder, &["--quiet", "lab", "--config", "mine.toml"], parts);
    }
}

#[test]
fn a_configuration_that_cannot_be_read_is_named() {
    let folder = folder();
    let parts = ["`nowhere.toml` (--config)", "No such file"];
    assert_wrong(&folder, &["lab", "--config", "nowhere.toml"], &parts);
    assert_wrong(&folder, &["lab", "--config", "."], &["`.` (--config)", "directory"]);
}

#[test]
fn an_output_folder_that_cannot_be_written_is_named() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").unwrap();
    assert_wrong(&folder, &["lab", "--out", "file"], &["`file` (--out)", "it is a file"]);
    assert_wrong(&folder, &["lab", "--out", "file/in"], &["`file/in` (--out)", "Not a directory"]);
    let shut = folder.path().join("shut");
    fs::create_dir(&shut).unwrap();
    let mut permissions = fs::metadata(&shut).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&shut, permissions).unwrap();
    // The superuser may write everywhere.
    if fs::write(shut.join("try"), "").is_err() {
        assert_wrong(&folder, &["lab", "--out", "shut"], &["`shut` (--out)", "ermission denied"]);
    }
}

#[test]
fn the_printed_configuration_is_accepted() {
    let folder = folder();
    let printed = libration(&folder).args(["lab", "--print-config"]).assert().success();
    let text = stdout(&printed.stderr(""));
    assert!(text.contains("k = 10.0  # stiffness in N/m"), "{text}");
    assert_eq!(
        libration_lab::STUDIES.parse(&text, ""),
        Ok(libration_lab::STUDIES.config()),
        "{text}"
    );
    assert!(entries(folder.path()).is_empty());
}

#[test]
fn the_schema_is_json() {
    let folder = folder();
    let printed = libration(&folder).args(["lab", "--schema"]).assert().success().stderr("");
    let schema: Value = serde_json::from_str(&stdout(&printed)).unwrap();
    assert_eq!(schema["properties"]["drift"]["properties"]["steps"]["minimum"], 1);
}

#[test]
fn the_list_fits_the_page_and_names_everything() {
    let folder = folder();
    let text = stdout(&libration(&folder).arg("list").assert().success().stderr(""));
    for line in text.lines() {
        assert!(line.chars().count() <= 100 && line.trim_end() == line, "{line:?}");
    }
    let integrators = libration::Method::ALL.map(libration::Method::name);
    let integrators = integrators.into_iter().chain(["exact"]);
    let systems = libration::catalog::ENTRIES.map(|entry| entry.name);
    let studies = libration_lab::STUDIES.studies.iter().map(|study| study.name());
    for name in integrators.chain(systems).chain(studies) {
        assert!(text.contains(&format!("\n  {name} ")), "{name} is not in\n{text}");
    }
}

#[test]
fn the_list_as_json_has_stable_keys() {
    let folder = folder();
    let printed = libration(&folder).args(["list", "--json"]).assert().success().stderr("");
    let list: Value = serde_json::from_str(&stdout(&printed)).unwrap();
    let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys(&list), ["integrators", "studies", "systems"]);
    assert_eq!(keys(&list["integrators"][0]), ["name", "order", "source", "summary"]);
    let system = &list["systems"][0];
    assert_eq!(keys(system), ["dimensions", "name", "parameters", "q", "summary", "v"]);
    assert_eq!(system["dimensions"], serde_json::json!({ "max": 8, "min": 1 }));
    let parameter = keys(&system["parameters"][0]);
    assert_eq!(parameter, ["allowed", "default", "name", "summary", "unit"]);
    assert_eq!(list["studies"].as_array().unwrap().len(), libration_lab::STUDIES.studies.len());
}

#[test]
fn completions_exist_for_every_shell() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = libration(&folder).args(["completions", shell]).assert().success().stderr("");
        script.stdout(contains("libration").and(contains("print-config")));
    }
}

#[test]
fn colour_is_used_only_where_it_is_wanted() {
    let folder = folder();
    fs::write(folder.path().join("mine.toml"), "zzz = 1\n").unwrap();
    // An error in the configuration, one of the command itself, and one of the command line.
    let errors: [&[&str]; 3] = [
        &["lab", "--config", "mine.toml"],
        &["lab", "--config", "nowhere.toml"],
        &["lab", "--effort", "quik"],
    ];
    for words in errors {
        let run = |color: &[&str], no_color: &str| {
            let mut command = libration(&folder);
            command.args(words).args(color).env("NO_COLOR", no_color);
            let stderr = command.assert().code(2).get_output().stderr.clone();
            stderr.contains(&b'\x1b')
        };
        assert!(!run(&[], ""), "{words:?}: colour without a terminal");
        assert!(!run(&["--color", "never"], ""), "{words:?}");
        assert!(run(&["--color", "always"], ""), "{words:?}");
        assert!(run(&["--color=always"], "1"), "{words:?}: a flag is stronger than NO_COLOR");
    }
}

#[test]
fn a_run_writes_results_says_where_and_gives_each_study_a_plain_line_without_a_terminal() {
    let folder = folder();
    // `cargo xtask report` runs them all.
    let studies = ["spectrum", "error", "determinism"];
    let words = ["lab", "--effort", "quick", "--out", "here"];
    let run = libration(&folder).args(words).args(studies).assert().success();
    let text = stdout(&run);
    assert!(text.ends_with("\nreport: here/report.html\n"), "{text}");
    for study in studies {
        assert!(text.contains(&format!("\n{study} ")), "{text}");
    }
    let results = fs::read(folder.path().join("here/results.json")).unwrap();
    let results: Value = serde_json::from_slice(&results).unwrap();
    assert_eq!(results["config"]["effort"], "quick");
    assert_eq!(results["studies"].as_array().unwrap().len(), studies.len());
    let stderr = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert_eq!(stderr.lines().count(), studies.len(), "{stderr}");
    assert!(!stderr.contains('\r') && !stderr.contains('\x1b'), "{stderr}");
    for (line, study) in stderr.lines().zip(studies) {
        assert!(line.ends_with(study), "{line}");
    }
}

/// Of one study; `cargo xtask report` insists on the silence of all.
#[test]
fn a_quiet_run_says_nothing_and_writes_into_the_folder_that_is_the_default() {
    let folder = folder();
    let run = libration(&folder).args(["lab", "--quiet", "--effort", "quick", "spectrum"]).assert();
    run.success().stdout("").stderr("");
    assert!(folder.path().join("libration-report/results.json").is_file());
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let folder = folder();
    for words in [&["list"][..], &["lab", "--print-config"], &["completions", "zsh"]] {
        let mut child = Process::new(assert_cmd::cargo::cargo_bin("libration"))
            .args(words)
            .current_dir(&folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The pipe is closed before, or soon after, the first write.
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{words:?}: {output:?}");
        assert!(output.stderr.is_empty(), "{words:?}: {output:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn results_that_cannot_be_written_are_a_failed_run() {
    let folder = folder();
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let status = Process::new(assert_cmd::cargo::cargo_bin("libration"))
        .arg("list")
        .current_dir(&folder)
        .stdout(full)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    assert_eq!(status.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&status.stderr).contains("cannot write to standard output"));
}
