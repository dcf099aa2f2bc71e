//! The command `simulate` as a user meets it.

use std::env;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::{contains, is_empty};
use serde_json::Value;
use tempfile::TempDir;

/// The report's oscillator.
const REPORT: &str = "simulate --system oscillator --set omega2=10 --integrator rk4 --dt 0.01 \
                      --steps 1000 --q 1 --v 0";

pub(crate) fn libration(folder: &TempDir, words: &str) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.current_dir(folder).args(words.split_whitespace());
    command
}

pub(crate) fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn names(folder: &TempDir) -> Vec<String> {
    let entries = fs::read_dir(folder.path()).unwrap();
    entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

pub(crate) fn stdout(folder: &TempDir, words: &str) -> String {
    let assert = libration(folder, words).assert().success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

#[test]
fn rows_are_csv_on_stdout() {
    let folder = folder();
    let text = stdout(&folder, &format!("{REPORT} --save-every 300"));
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines[0], "step,t,q,q',energy");
    assert_eq!(lines[1], "0,0.0,1.0,0.0,5.0");
    let steps: Vec<_> = lines[1..].iter().map(|l| l.split(',').next().unwrap()).collect();
    assert_eq!(steps, ["0", "300", "600", "900", "1000"]);
    let last: Vec<f64> = lines[5].split(',').map(|x| x.parse().unwrap()).collect();
    // Exact arithmetic gives these after 1000 steps; the rounding bound is 1e-12.
    assert!((last[2] - 0.9786827438668632).abs() < 1e-12);
    assert!((last[3] - -0.6494618770187763).abs() < 1e-12);
}

#[test]
fn negative_and_many_coordinates() {
    let folder = folder();
    let words = "simulate --system oscillator --integrator leapfrog --dt 0.1 --steps 1 \
                 --q -1,2,0.5 --v -0.3,0,-1e-3";
    let text = stdout(&folder, words);
    let mut lines = text.lines();
    assert_eq!(lines.next().unwrap(), "step,t,q0,q1,q2,q0',q1',q2',energy");
    assert!(lines.next().unwrap().starts_with("0,0.0,-1.0,2.0,0.5,-0.3,0.0,-0.001,"));
}

#[test]
fn formats_agree() {
    let folder = folder();
    let words = format!("{REPORT} --save-every 100");
    let csv = stdout(&folder, &words);
    let text = stdout(&folder, &format!("{words} --format json"));
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["columns"], serde_json::json!(["step", "t", "q", "q'", "energy"]));
    assert_eq!(json["units"], serde_json::json!(["1", "s", "m", "m/s", "J/kg"]));
    assert_eq!((&json["parameters"]["omega2"], &json["stopped"]), (&10.0.into(), &Value::Null));
    // Digit by digit: not every JSON reader rounds to the nearest float.
    let rows = text.lines().filter_map(|line| line.strip_prefix("    ["));
    let rows = rows.map(|line| line.trim_end_matches([']', ',']).replace(", ", ","));
    assert!(csv.lines().skip(1).eq(rows));
    let npy = libration(&folder, &format!("{words} --format npy")).assert().success();
    let npy = &npy.get_output().stdout;
    let records = &npy[npy.len() - 11 * 40..];
    let q = records.chunks(40).map(|r| f64::from_le_bytes(r[16..24].try_into().unwrap()));
    for (line, q) in csv.lines().skip(1).zip(q) {
        assert_eq!(line.split(',').nth(2).unwrap().parse::<f64>().unwrap(), q);
    }
}

#[test]
fn the_format_follows_the_extension() {
    let folder = folder();
    for (name, magic) in [
        ("x.csv", b"step".as_slice()),
        ("x.json", b"{\n"),
        ("x.npy", b"\x93NUMPY"),
        ("x.PARQUET", b"PAR1"),
        ("x", b"step"),
    ] {
        let words = format!("{REPORT} --output {name}");
        libration(&folder, &words).assert().success().stdout(is_empty()).stderr(is_empty());
        assert!(fs::read(folder.path().join(name)).unwrap().starts_with(magic), "{name}");
    }
    libration(&folder, &format!("{REPORT} --format npy --output y")).assert().success();
    assert!(fs::read(folder.path().join("y")).unwrap().starts_with(b"\x93NUMPY"));
    assert_eq!(names(&folder).len(), 6, "no temporary file stays");
}

#[test]
fn an_overflow_keeps_its_rows_and_ends_with_exit_code_1() {
    let folder = folder();
    let words = "simulate --system oscillator --integrator explicit-euler --dt 0.1 --steps 1e5";
    // A step stretches the state by |1 + i z| = sqrt 1.1, and 10 q is what overflows first. It does
    // within a period, 20 steps, of this one.
    let guess = ((f64::MAX / 10.0).log10() / 1.1_f64.sqrt().log10()) as u64;
    let assert = libration(&folder, words).assert().code(1);
    let text = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    let last: u64 = text.lines().last().unwrap().split(',').next().unwrap().parse().unwrap();
    assert!(last.abs_diff(guess) < 20, "{last} is not near {guess}");
    let warning = format!("warning: the last row is step {last}: at step {} (t = ", last + 1);
    let why = "the state stopped being finite: explicit-euler is unstable with every time step: \
               a smaller --dt only delays the overflow; choose another --integrator";
    assert.stderr(contains(warning).and(contains(why)));
    libration(&folder, words).arg("--quiet").assert().code(1).stderr(is_empty());
    let json = libration(&folder, &format!("{words} --format json")).assert().code(1);
    let json: Value = serde_json::from_slice(&json.get_output().stdout).unwrap();
    assert_eq!(json["stopped"]["step"], last + 1);
    assert_eq!(json["stopped"]["reason"], why);
}

#[test]
fn wrong_input_is_named_with_what_is_allowed() {
    let folder = folder();
    fs::create_dir(folder.path().join("taken")).unwrap();
    let cases: &[(&str, &[&str])] = &[
        ("--dt 0", &["--dt", "0", "greater than 0"]),
        ("--dt -1", &["--dt", "-1", "greater than 0"]),
        ("--dt nan", &["--dt", "nan", "finite"]),
        ("--dt 1e-9 --dtype f16", &["--dt", "1e-9", "f16"]),
        ("--dt 1e39 --dtype f32", &["--dt", "1e39", "f32"]),
        ("--dtype f128", &["--dtype", "f128", "f64, f32, f16, bf16"]),
        ("--steps 0", &["--steps", "0", "1 to"]),
        ("--steps 1.5", &["--steps", "1.5"]),
        ("--steps 1e15 --format npy", &["GB of memory are needed", "--save-every"]),
        ("--steps 1e15 --format parquet", &["GB of memory are needed", "--save-every"]),
        ("--save-every 0", &["--save-every", "0", "at least 1"]),
        ("--save-every -3", &["--save-every", "-3", "at least 1"]),
        ("--format xml", &["--format", "xml", "csv, json, npy, parquet"]),
        ("--integrator rk5", &["--integrator", "rk5", "rk4"]),
        ("--system osscillator", &["--system", "osscillator", "oscillator"]),
        ("--set k=-1", &["k", "-1", "at least 0"]),
        ("--set omega2=1e9 --dtype f16", &["omega2", "f16", "--dtype"]),
        ("--q 1,2", &["--q", "1,2", "--v"]),
        ("--q 1,x", &["--q", "x", "commas"]),
        ("--q 1e6 --v 0 --dtype f16", &["--q", "1000000", "f16"]),
        ("--output taken", &["taken", "--output"]),
        ("--output a.xyz", &["a.xyz", "--output", ".parquet", "--format"]),
        ("--format json --output y.csv", &["json", "y.csv", "contradict"]),
        ("--output no/such/x.csv", &["no/such/x.csv", "--output"]),
    ];
    let basic = [
        ("--system", "oscillator"),
        ("--integrator", "rk4"),
        ("--dt", "0.01"),
        ("--steps", "10"),
        ("--v", "0"),
    ];
    for (flags, parts) in cases {
        let given: Vec<_> = flags.split_whitespace().collect();
        let rest = basic.iter().filter(|(flag, _)| !given.contains(flag));
        let rest: String = rest.map(|(flag, value)| format!("{flag} {value} ")).collect();
        let words = format!("simulate {rest} {flags}");
        let mut assert = libration(&folder, &words).assert().code(2).stdout(is_empty());
        for part in *parts {
            assert = assert.stderr(contains(*part));
        }
    }
    assert_eq!(names(&folder), ["taken"]);
}

#[cfg(unix)]
#[test]
fn an_output_that_is_no_regular_file_is_written_to() {
    libration(&folder(), &format!("{REPORT} --output /dev/null")).assert().success();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn a_wrong_request_leaves_the_old_file() {
    let folder = folder();
    let path = folder.path().join("x.csv");
    fs::write(&path, "precious").unwrap();
    let words = format!("{} --output x.csv", REPORT.replace("--q 1", "--q 1e6 --dtype f16"));
    libration(&folder, &words).assert().code(2);
    assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
    assert_eq!(names(&folder), ["x.csv"]);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    for format in ["csv", "json"] {
        let words = REPORT.replace("1000", "100000000");
        let mut child = Process::new(assert_cmd::cargo::cargo_bin!("libration"))
            .args(words.split_whitespace())
            .args(["--format", format])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    }
}

/// A Python with NumPy: `LIBRATION_PYTHON`, or a virtual environment in `target/python`.
fn python() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let local = root.join("target/python/bin/python");
    env::var_os("LIBRATION_PYTHON").map(PathBuf::from).or_else(|| local.exists().then_some(local))
}

#[test]
fn numpy_reads_what_was_written() {
    let Some(python) = python() else {
        eprintln!("skipped: set LIBRATION_PYTHON to a Python that has NumPy");
        return;
    };
    let folder = folder();
    for (float, dtype) in [("f64", "f8"), ("f32", "f4"), ("f16", "f2"), ("bf16", "f4")] {
        let words = format!("{REPORT} --dtype {float}");
        let long =
            words.replace("--dtype f", "--dtype float").replace("--dtype bf", "--dtype bfloat");
        assert_eq!(stdout(&folder, &long), stdout(&folder, &words));
        libration(&folder, &format!("{words} --output x.npy")).assert().success();
        libration(&folder, &format!("{words} --output x.csv")).assert().success();
        let script = format!(
            "import numpy as np, csv\n\
             a = np.load('x.npy')\n\
             rows = list(csv.reader(open('x.csv')))\n\
             assert list(a.dtype.names) == rows[0], a.dtype\n\
             assert [a.dtype[n].str for n in a.dtype.names] == ['<u8', '<f8'] + 3*['<{dtype}']\n\
             assert len(a) == len(rows) - 1 == 1001\n\
             assert (a['step'] == np.arange(1001)).all()\n\
             for i, name in enumerate(rows[0]):\n\
             \x20   text = [r[i] for r in rows[1:]]\n\
             \x20   back = np.array(text, dtype='f8').astype(a.dtype[name])\n\
             \x20   if '{float}' == 'bf16' and i > 1:\n\
             \x20       bits = a[name].view('u4')\n\
             \x20       assert not (bits & 0xffff).any()\n\
             \x20       assert (abs(back - a[name]) <= abs(back) / 256).all()\n\
             \x20   else:\n\
             \x20       assert (back == a[name]).all(), name\n"
        );
        let output =
            Process::new(&python).current_dir(&folder).args(["-c", &script]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn many_trajectories_have_the_same_bits_on_every_instruction_set_and_number_of_threads() {
    let folder = folder();
    let words = "simulate --system kepler --integrator suzuki4 --dt 0.01 --steps 20 --save-every 20 \
                 --num-trajectories 500 --spread 0.1 --dtype f32";
    let here = stdout(&folder, words);
    assert!(here.starts_with("trajectory,step,t,x,y,x',y',energy\n0,0,0.0,"), "{here:.80}");
    assert_eq!(here.lines().count(), 1 + 2 * 500);
    for more in ["--simd baseline", "--threads 1", "--threads 3 --simd baseline"] {
        assert_eq!(stdout(&folder, &format!("{words} {more}")), here, "{more}");
    }
}

#[test]
fn flags_of_many_trajectories_without_a_count_are_refused() {
    let folder = folder();
    for more in [
        "--spread 0.1",
        "--simd baseline",
        "--threads 2",
        "--num-trajectories 0",
        "--num-trajectories 1e30",
    ] {
        libration(&folder, &format!("{REPORT} {more}"))
            .assert()
            .code(2)
            .stderr(contains("--num-trajectories"));
    }
    libration(&folder, &format!("{REPORT} --num-trajectories 2 --simd mmx")).assert().code(2);
    let f16 = format!("{REPORT} --num-trajectories 2 --dtype f16");
    libration(&folder, &f16).assert().code(2).stderr(contains("--dtype is f16"));
}
