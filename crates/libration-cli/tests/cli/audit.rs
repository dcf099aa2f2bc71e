//! `audit`.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use predicates::prelude::*;
use serde_json::Value;

use super::advise::libration;

/// Writes the energies of an oscillator by velocity Verlet, with a force of friction `−damping·v` that does not belong to its energy.
fn run(folder: &Path, dt: f64, damping: f64) -> PathBuf {
    let (mut q, mut v) = (1.0_f64, 0.0_f64);
    let mut text = "t,E\n".to_owned();
    for step in 0..=(200.0 / dt) as usize {
        let _ = writeln!(text, "{},{}", step as f64 * dt, 0.5 * (q * q + v * v));
        v -= 0.5 * dt * (q + damping * v);
        q += dt * v;
        v -= 0.5 * dt * (q + damping * v);
    }
    let path = folder.join(format!("{dt}.csv"));
    fs::write(&path, text).unwrap();
    path
}

fn audit(files: &[&Path], more: &[&str]) -> assert_cmd::assert::Assert {
    let files = files.iter().map(|path| path.to_str().unwrap());
    let words: Vec<&str> = ["audit", "--energy", "E"].into_iter().chain(files).collect();
    libration(&[&words[..], more].concat())
}

#[test]
fn energies_of_a_clean_program_have_no_fault_and_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let files = [0.2, 0.1, 0.05].map(|dt| run(folder.path(), dt, 0.0));
    let files = files.each_ref().map(PathBuf::as_path);
    let page = folder.path().join("audit.html");
    let steps = ["--dt", "0.2,0.1,0.05"];
    let more = [&steps[..], &["--horizon", "1000", "--page", page.to_str().unwrap()]].concat();
    audit(&files, &more).success().stdout(
        predicate::str::contains("3 runs: no fault. The energy oscillates with order 2")
            .and(predicate::str::contains("The largest step for a deviation of 0.0001"))
            .and(predicate::str::contains("repeat with: libration audit")),
    );
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("How do they depend on the time step?") && page.contains("energy-laws"));
    // Thinned traces have their steps from the option.
    audit(&files, &["--dt", "0.1,0.05,0.025"]).success();
    // Without them there is no largest step.
    audit(&files, &[]).success().stdout(
        predicate::str::contains("dt assumed: the spacing of the samples")
            .and(predicate::str::contains("The largest step for").not()),
    );
}

#[test]
fn an_exceeded_tolerance_and_an_unknown_law_are_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let files = [0.2, 0.1, 0.05].map(|dt| run(folder.path(), dt, 0.0));
    let files = files.each_ref().map(PathBuf::as_path);
    // Verlet from q = 1 deviates by h²/4 of the energy: 625 to 10,000 times 10⁻⁶.
    audit(&files, &["--tolerance", "1e-6"]).code(1).stdout(
        predicate::str::contains("3 runs: no fault; the tolerance is exceeded: 3 of 3 runs deviate by 625 to 10\u{202f}000 times")
            .and(predicate::str::contains("are in the unit of the energies")),
    );
    audit(&files, &["--tolerance", "0.011"])
        .success()
        .stdout(predicate::str::contains("within the tolerance: 3 runs deviate by at most"));
    // An energy that changes by the same amount twice in each run, whatever the step.
    let jumps = [0.2, 0.1].map(|dt| {
        let path = folder.path().join(format!("jump{dt}.csv"));
        let mut text = "t,E\n".to_owned();
        for step in 0..=(200.0 / dt) as usize {
            let t = step as f64 * dt;
            let energy = 5.0 + if (50.0..150.0).contains(&t) { 0.01 } else { 0.0 };
            let _ = writeln!(text, "{t},{}", energy + 1e-3 * dt * dt * (3.0 * t).sin());
        }
        fs::write(&path, text).unwrap();
        path
    });
    let output = audit(&jumps.each_ref().map(PathBuf::as_path), &["--json"]).code(1);
    let report: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    assert_eq!(report["verdict"]["outcome"], "unknown", "{report}");
    assert_eq!(report["tolerance_verdict"], Value::Null);
}

#[test]
fn a_column_of_time_has_precedence_over_one_of_steps() {
    let folder = tempfile::tempdir().unwrap();
    for (name, per_second) in
        [("time", 1.0), ("t", 1.0), ("time_ps", 1e12), ("time [ps]", 1e12), ("Time (fs)", 1e15)]
    {
        let files = [0.2, 0.1].map(|dt| {
            let path = run(folder.path(), dt, 0.0);
            let text = fs::read_to_string(&path).unwrap();
            let mut rows = format!("step,{name},E\n");
            for (step, line) in text.lines().skip(1).enumerate() {
                let (time, energy) = line.split_once(',').unwrap();
                let time = time.parse::<f64>().unwrap() * per_second;
                let _ = writeln!(rows, "{step},{time:e},{energy}");
            }
            fs::write(&path, rows).unwrap();
            path
        });
        let files = files.each_ref().map(PathBuf::as_path);
        let report = audit(&files, &["--json"]).success().get_output().stdout.clone();
        let report: Value = serde_json::from_slice(&report).unwrap();
        let dt = report["runs"][0]["dt"].as_f64().unwrap();
        assert!((dt - 0.1).abs() < 1e-9, "{name}: {dt}");
    }
}

#[test]
fn friction_is_named_and_the_exit_code_is_1() {
    let folder = tempfile::tempdir().unwrap();
    let files = [0.2, 0.1].map(|dt| run(folder.path(), dt, 1e-4));
    let output = audit(&files.each_ref().map(PathBuf::as_path), &["--json"]).code(1);
    let report: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    assert_eq!(report["findings"][0]["kind"], "step-independent-drift");
    // The energy ½ decays at the rate of the damping; over 200 s the mean rate is 1 % less, if it is not exponential already.
    let rate = report["runs"][0]["drift_rate"]["value"].as_f64().unwrap();
    assert!((rate / -0.5e-4 - 1.0).abs() < 0.02, "{rate}");
}

#[test]
fn unusable_files_are_refused_with_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = [0.2, 0.1].map(|dt| run(folder.path(), dt, 0.0));
    let refused = |files: &[&Path], more: &[&str], part: &str| {
        audit(files, more).code(2).stderr(predicate::str::contains(part.to_owned()));
    };
    refused(&[&a], &[], "1 trace given; expected at least 2");
    refused(&[&a, &a], &[], "have the same time step, 0.2 s");
    refused(&[&a, &b], &["--dt", "0.1"], "--dt has 1 time step for 2 files");
    refused(&[&a, &b], &["--dt", "0.3,0.1"], "expected at least a step between samples");
    refused(&[&a, &b], &["--tolerance", "0"], "expected a number above 0");
    refused(&[&a, &b], &["--time", "tt"], "no column `tt`");
    refused(&[&a, &folder.path().join("none.csv")], &[], "none.csv");
    let words = ["audit", a.to_str().unwrap(), b.to_str().unwrap(), "--energy", "energy"];
    libration(&words).code(2).stderr(predicate::str::contains("has no signal `energy`"));
    let write = |text: &str| {
        let path = folder.path().join("bad.csv");
        fs::write(&path, format!("t,E\n{text}")).unwrap();
        path
    };
    let rows = |row: &dyn Fn(usize) -> String| (0..2001).map(row).collect::<String>();
    let constant = write(&rows(&|i| format!("{},1.5\n", 0.1 * i as f64)));
    refused(&[&a, &constant], &[], "is constant: 1.5");
    let infinite = write(&rows(&|i| {
        let energy = if i == 9 { "inf" } else { "1.5" };
        format!("{},{energy}\n", 0.1 * i as f64)
    }));
    refused(&[&a, &infinite], &[], "expected a finite number");
    let short = write("0,1\n0.1,2\n");
    refused(&[&a, &short], &[], "has 2 samples; expected at least 128");
}
