//! Programs of `probe --command`: how they end, and how their failures read.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use libration_report::printable::printable;
use predicates::prelude::*;
use predicates::str::contains;

use super::advise::libration;
use super::interrupt::{interrupt, wait_until};

/// A command in a folder that never answers, and whose identifier is in `id`.
const HANGING: &str = "#!/bin/sh\necho $$ > id.new\nmv id.new id\nexec sleep 60\n";

/// Starts an audit in a folder, of a shell that starts the program that hangs and waits for it.
fn audit_of_hanging(folder: &tempfile::TempDir, more: &[&str]) -> Child {
    fs::write(folder.path().join("hang.sh"), HANGING).unwrap();
    Command::new(assert_cmd::cargo::cargo_bin("libration"))
        .args(["probe", "--command", "sh -c 'sh hang.sh & wait'", "--state", "0", "--dt", "0.1"])
        .args(more)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The identifier of the program that hangs.
fn id_of_hanging(folder: &tempfile::TempDir) -> String {
    let path = folder.path().join("id");
    wait_until("the program", || path.is_file());
    fs::read_to_string(path).unwrap().trim().to_owned()
}

/// Whether a process runs; a zombie does not.
fn runs(id: &str) -> bool {
    let output = Command::new("ps").args(["-o", "stat=", "-p", id]).output().unwrap();
    let state = String::from_utf8(output.stdout).unwrap();
    !state.trim().is_empty() && !state.trim().starts_with('Z')
}

#[test]
fn the_earlier_of_both_limits_of_time_ends_an_audit_and_its_message_names_it() {
    for (limits, part, other) in [
        (
            ["--time-limit", "1", "--timeout", "20"],
            "the audit was ended after 1 s and 0 steps (--time-limit): `sh` gave no answer",
            "within 20 s",
        ),
        (
            ["--time-limit", "20", "--timeout", "1"],
            "`sh` gave no answer within 1 s",
            "--time-limit",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let start = Instant::now();
        let output = audit_of_hanging(&folder, &limits).wait_with_output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
        assert!(errors.contains(part) && !errors.contains(other), "{errors}");
        let id = id_of_hanging(&folder);
        wait_until("the end of what the program started", || !runs(&id));
    }
}

#[test]
fn a_signal_that_ends_an_audit_ends_all_processes_of_its_program() {
    for signal in ["INT", "TERM"] {
        let folder = tempfile::tempdir().unwrap();
        let mut child = audit_of_hanging(&folder, &["--timeout", "50"]);
        let id = id_of_hanging(&folder);
        assert!(runs(&id));
        match signal {
            "INT" => interrupt(&child),
            _ => {
                let kill = Command::new("kill").arg(child.id().to_string()).status();
                assert!(kill.unwrap().success());
            }
        }
        wait_until("the end of the audit", || child.try_wait().unwrap().is_some());
        wait_until("the end of what the program started", || !runs(&id));
        let output = child.wait_with_output().unwrap();
        let code = if signal == "INT" { Some(130) } else { None };
        assert_eq!(output.status.code(), code, "{output:?}");
        assert!(!String::from_utf8_lossy(&output.stderr).contains("error"), "{output:?}");
    }
}

#[test]
fn a_program_that_ends_is_reported_with_its_status() {
    for (command, part) in [
        ("sh -c 'exit 3'", "`sh` ended (exit status: 3) after 0 lines; expected an answer"),
        ("sh -c 'exec >&-; sleep 0.05; exit 4'", "`sh` ended (exit status: 4) after 0 lines"),
        ("sh -c 'read x; echo 0; exit 5'", "`sh` ended (exit status: 5) after 1 line;"),
        ("sh -c 'exec >&-; sleep 60'", "`sh` closed its output after 0 lines"),
        ("sh -c 'read x; echo y; read z'", "`sh` answered `y`; expected 1 number\n"),
    ] {
        for _ in 0..5 {
            libration(&["probe", "--command", command, "--state", "0", "--dt", "0.1"])
                .code(1)
                .stderr(contains(part).and(contains(format!("auditing the step of {command}\n"))));
        }
    }
}

#[test]
fn a_result_that_is_not_finite_names_the_option_that_helps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("step.py");
    let audit = |from: &str| {
        // Beyond 0.003 there is no result.
        let text = "import sys\nfor line in sys.stdin:\n    x = float(line.split()[0])\n    print('nan' if x > 0.003 else x, flush=True)\n";
        fs::write(&path, text).unwrap();
        let command = format!("python3 {}", path.display());
        libration(&["probe", "--command", &command, "--state", from, "--dt", "0.1"]).code(1)
    };
    audit("0.004").stderr(contains("at which the step is defined (--state, --action)"));
    audit("0").stderr(contains("smaller typical deviations (--state-scale) keep"));
}

#[test]
fn a_plant_goes_to_a_file_whose_format_is_known() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["x.json", "plant", "plant.toml.gz"] {
        let path = folder.path().join(name);
        let words = ["--state", "0", "--dt", "1", "--save-plant", path.to_str().unwrap()];
        libration(&[&["probe", "--command", "nosuchprogram"][..], &words].concat())
            .code(2)
            .stderr(contains("(--save-plant): plants are TOML; expected a file name that ends in"));
        assert!(!path.exists());
    }
}

#[test]
fn a_plant_in_which_an_action_has_no_effect_is_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.toml");
    let command = "sh -c 'while read q v u dt; do echo $q $v; done'";
    let words = ["probe", "--command", command, "--state", "0,0", "--action", "0", "--dt", "0.1"];
    libration(&[&words[..], &["--save-plant", path.to_str().unwrap()]].concat())
        .code(1)
        .stderr(contains("--save-plant: the effect of `u1` is zero in the matrices of the step"));
    assert!(!path.exists());
}

#[test]
fn a_saved_plant_is_read_again_whatever_its_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.toml");
    // A line break in the title would end the comment in front of the plant.
    let command = "python3 -c 'import sys\nfor line in sys.stdin:\n    q, v, u, dt = map(float, line.split())\n    \
                   print(q + dt * u, v, flush=True)\nb = [[7.0], [7.0]]'";
    for names in [
        ["Gelenk é", "nœud\u{a0}x"],
        ["a\"b\\c", "関節"],
        ["\u{202e}back", "\u{1f916}'s\u{a0}\u{200b}"],
        ["\\u0041", "#"],
        ["a\nb = 1", "tab\there"],
        ["\u{1b}[31mred", "\u{7f}\u{85}z"],
    ] {
        let words =
            ["probe", "--command", command, "--state", "0,0", "--action", "0", "--dt", "0.1"];
        let names_option = names.join(",");
        let more = ["--state-names", &names_option, "--save-plant", path.to_str().unwrap()];
        libration(&[&words[..], &more].concat());
        let text = fs::read_to_string(&path).unwrap();
        let plant = libration_settings::linear_loop::read_plant(&path).unwrap();
        let plant = plant.plant().unwrap_or_else(|fault| panic!("{fault}: {text}"));
        let found: Vec<&str> = plant.states.iter().map(|signal| signal.name.as_str()).collect();
        // What acts on a terminal is text of its escape.
        assert_eq!(found, names.map(printable), "{text}");
        // Differences have seven digits; a line of the title would make it 7.
        assert!((plant.b.row(0)[0] - 1.0).abs() < 1e-6, "{text}");
    }
}
