//! `probe` and `gains`.

use std::fs;
use std::path::PathBuf;

use predicates::prelude::*;
use serde_json::Value;

use super::advise::libration;

/// A pendulum: kick, then drift, with `damping` in 1/s, in the language that each test machine has besides Rust.
fn pendulum(folder: &tempfile::TempDir, damping: f64) -> PathBuf {
    let path = folder.path().join("step.py");
    let text = format!(
        "import math, sys\nfor line in sys.stdin:\n    q, v, u, dt = map(float, line.split())\n    v += dt * (-9.0 * math.sin(q) - {damping} * v + u)\n    print(q + dt * v, v, flush=True)\n"
    );
    fs::write(&path, text).unwrap();
    path
}

fn probe(path: &std::path::Path, more: &[&str]) -> assert_cmd::assert::Assert {
    let command = format!("python3 {}", path.display());
    let words = ["probe", "--command", &command, "--state", "0,0", "--action", "0", "--dt", "0.01"];
    libration(&[&words[..], more].concat())
}

#[test]
fn the_step_of_another_program_is_audited_and_its_page_answers_first() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("probe.html");
    let step = pendulum(&folder, 0.2);
    let names = "angle (rad),speed (rad/s)";
    probe(&step, &["--state-names", names, "--page", page.to_str().unwrap()]).success().stdout(
        predicate::str::contains("By its results the step is that of symplectic Euler, of order 1")
            .and(predicate::str::contains("No fault was found"))
            .and(predicate::str::contains("repeat with: libration probe --command")),
    );
    let page = fs::read_to_string(page).unwrap();
    let version = format!("<code>libration probe</code> {}", env!("CARGO_PKG_VERSION"));
    assert!(page.contains(&version));
    assert!(page.contains("the longest stable step is") && page.contains("speed, angle"));
}

#[test]
fn a_fault_of_the_step_is_named_and_the_exit_code_is_1() {
    let folder = tempfile::tempdir().unwrap();
    let step = pendulum(&folder, -0.2);
    let output = probe(&step, &["--json", "--conservative"]).code(1).get_output().stdout.clone();
    let report: Value = serde_json::from_slice(&output).unwrap();
    assert_eq!(report["findings"][0]["kind"], "negative-damping");
    // ∂v̇/∂v.
    let rate = report["driven_velocities"][0]["rate"].as_f64().unwrap();
    assert!((rate - 0.2).abs() < 1e-8, "{rate}");
}

#[test]
fn the_exit_code_follows_from_the_verdict_and_unknown_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("euler.py");
    let text = "import sys\nfor line in sys.stdin:\n    q, v, u, dt = map(float, line.split())\n    print(q + dt * v, v + dt * (u - 9 * q), flush=True)\n";
    fs::write(&path, text).unwrap();
    for (more, outcome) in [(&[][..], "fault"), (&["--fixed-dt"], "unknown")] {
        let words = [more, &["--json"]].concat();
        let output = probe(&path, &words).code(1).get_output().stdout.clone();
        let report: Value = serde_json::from_slice(&output).unwrap();
        assert_eq!(report["verdict"]["outcome"], outcome);
        probe(&path, more).code(1).stdout(predicate::str::contains("No fault").not());
    }
}

#[test]
fn a_program_that_fails_ends_the_run_with_its_name_and_what_it_did() {
    for (command, part) in [
        ("nosuchprogram", "cannot start `nosuchprogram`"),
        ("cat", "`cat` answered with 3 numbers: `0.0 1.0 0.1`; expected 2"),
        ("sh -c 'read x; echo hello; read y'", "`sh` answered `hello`; expected 2 numbers"),
        ("sleep 60", "`sleep` gave no answer within 0.2 s"),
    ] {
        let words = ["--state", "0,1", "--dt", "0.1", "--timeout", "0.2"];
        let code = if command == "nosuchprogram" { 2 } else { 1 };
        libration(&[&["probe", "--command", command][..], &words].concat())
            .code(code)
            .stderr(predicate::str::contains(part));
    }
}

#[test]
fn an_audit_ends_with_its_limit_of_time_and_shows_some_messages_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slow.py");
    let text = "import sys, time\nfor _ in range(8): print('x' * 9999, file=sys.stderr)\nfor line in sys.stdin:\n    time.sleep(0.01)\n    print(*line.split()[:2], flush=True)\n";
    fs::write(&path, text).unwrap();
    let output = probe(&path, &["--time-limit", "1.5"]).code(1).get_output().stderr.clone();
    let errors = String::from_utf8(output).unwrap();
    assert!(errors.contains("the audit was ended after 1.5 s and"), "{errors}");
    // 64 KiB of messages, a line that says that there were more, and the two of the program itself.
    assert!((65_536..66_500).contains(&errors.len()), "{}", errors.len());
    assert!(errors.contains("(more messages of the program are left out)"), "{errors}");
    probe(&path, &["--time-limit", "0"])
        .code(2)
        .stderr(predicate::str::contains("a number of seconds above 0, at most 1000000"));
}

#[test]
fn wrong_options_name_the_option_and_what_is_allowed() {
    for (words, part) in [
        (&["--command", "cat", "--dt", "0.1"][..], "without --state"),
        (&["--command", "cat", "--state", "0"], "without --dt"),
        (&["--command", "cat", "--state", "nan", "--dt", "1"], "expected finite numbers"),
        (&["--command", "cat", "--state", "0", "--dt", "0"], "greater than 0"),
        (&["--command", "'cat", "--state", "0", "--dt", "1"], "quotation mark"),
        (
            &["--command", "cat", "--state", "0,1", "--dt", "1", "--state-names", "a"],
            "--state-names has 1 name; expected 2",
        ),
        (
            &[
                "--command",
                "cat",
                "--state",
                "0,1",
                "--dt",
                "1",
                "--state-names",
                "a,b",
                "--state-scale",
                "1,0",
            ],
            "--state-scale is 0 for `b`; expected finite numbers above 0",
        ),
        (&["--mujoco", "nosuch.xml"], "there is no such file"),
        (&["--matrices", "nosuch.npz"], "--matrices"),
        (&["--mujoco", "a.xml", "--command", "cat"], "cannot be used with"),
        (&["--matrices", "a.npz", "--keyframe", "home"], "--mujoco"),
    ] {
        libration(&[&["probe"][..], words].concat()).code(2).stderr(predicate::str::contains(part));
    }
}

#[test]
fn matrices_of_a_step_have_modes_but_those_in_continuous_time_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("step.toml");
    let with = |text: &str| {
        fs::write(&file, text).unwrap();
        libration(&["probe", "--matrices", file.to_str().unwrap(), "--json"])
    };
    let text = "a = [[1, 0.1], [-0.9, 0.91]]\nb = [[0.005], [0.1]]\n";
    let output =
        with(&format!("{text}sampling-period = 0.1\n")).success().get_output().stdout.clone();
    let report: Value = serde_json::from_slice(&output).unwrap();
    // |z|² is the determinant, 0.91 + 0.09.
    assert!((report["spectral_radius"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    assert_eq!(report["findings"], Value::Array(vec![]));
    with(text).code(2).stderr(predicate::str::contains("a plant in continuous time"));
}

#[test]
fn gains_hold_up_to_the_limit_of_theory_and_else_the_answer_says_what_holds_them() {
    let limit = |kp: &str, more: &[&str]| {
        let words = ["gains", "--inertia", "0.01", "--kp", kp, "--kv", "1", "--dt", "0.005"];
        libration(&[&words[..], more].concat())
    };
    // kp < 4 M/h² − 2 kv/h = 1600 − 400.
    limit("1199", &[]).success().stdout(predicate::str::contains("The gains hold"));
    limit("1201", &[]).code(1).stdout(
        predicate::str::contains("2 substeps hold them")
            .and(predicate::str::contains("damping-implicit")),
    );
    limit("1201", &["--integrator", "implicitfast"]).success();
    let finite = |kp: &str| {
        let output = limit(kp, &[]).get_output().stdout.clone();
        String::from_utf8(output).unwrap()
    };
    assert!(!finite("0").contains("NaN"));
    assert!(finite("1e9").contains("1.2·10⁻⁶") && finite("1e300").len() < 4000);
    limit("1", &["--integrator", "euler2"])
        .code(2)
        .stderr(predicate::str::contains("unknown integrator; expected one of explicit-euler"));
    libration(&["gains", "--inertia", "1,2", "--kp", "1", "--dt", "0.01"])
        .code(2)
        .stderr(predicate::str::contains("--kp has 1 number; expected 2"));
    libration(&["gains", "--inertia", "1,0", "--kp", "1,1", "--dt", "0.01"])
        .code(2)
        .stderr(predicate::str::contains("--inertia is 0 for `joint 2`; expected numbers above 0"));
}

#[test]
fn the_plant_of_a_step_goes_to_advise() {
    let folder = tempfile::tempdir().unwrap();
    let step = pendulum(&folder, 0.2);
    let plant = folder.path().join("plant.toml");
    let plant = plant.to_str().unwrap();
    probe(&step, &["--state-names", "angle (rad),speed (rad/s)", "--save-plant", plant]).success();
    let words = ["--lqr", "10,1/0.1", "--period", "0.01", "--latency", "0.024"];
    libration(&[&["advise", "--plant", plant][..], &words].concat())
        .success()
        .stdout(predicate::str::contains("The loop is stable with the stated imperfections"));
}
