//! Warnings about logs, wherever a command reads one.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use predicates::prelude::*;

use super::advise::{ADVISE, json, libration};

/// Writes a log with a time in whole ms that has no unit.
fn whole_milliseconds(folder: &Path) -> String {
    let mut text = "t,cmd,q,E\n".to_owned();
    for i in 0..100_u32 {
        let command = |i: u32| f64::from(i / 10 * 7919 % 31) / 31.0;
        let energy = 1.0 + 1e-3 * f64::from(i * 7919 % 97) / 97.0;
        let _ =
            writeln!(text, "{},{},{},{energy}", 10 * i, command(i), command(i.saturating_sub(2)));
    }
    let path = folder.join("log.csv");
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn each_command_warns_of_a_guessed_unit() {
    let folder = tempfile::tempdir().unwrap();
    let log = whole_milliseconds(folder.path());
    let warning = "log.csv`: the unit of `t` is assumed to be s; help: --time-unit";
    let identify = ["identify", &log, "--command", "cmd", "--response", "q", "--bootstrap", "0"];
    let simulate = ["simulate", "--system", "oscillator", "--integrator", "velocity-verlet"];
    let steps = ["--dt", "0.01", "--steps", "3", "--time-stamps", &log];
    let replay = ["10,2", "--period", "8", "--jitter-file", &log];
    for words in [
        identify.to_vec(),
        vec!["measure-jitter", "--from", &log],
        [&simulate[..], &steps].concat(),
        [&ADVISE[..], &replay].concat(),
    ] {
        let found = libration(&words);
        found.stderr(predicate::str::contains(warning).count(1));
    }
    let found = json(&identify);
    let first = found["warnings"][0].as_str().unwrap();
    assert!(first.contains(warning), "{first}");
    // An audit keeps the unit of the file, unless it converts.
    let audit = |log: &str| libration(&["audit", log, log, "--energy", "E", "--dt", "10,5"]);
    audit(&log).stderr(predicate::str::contains("assumed").not());
    let text = fs::read_to_string(&log).unwrap();
    let rows = text.lines().map(|line| line.replacen(',', "00000,", 1) + "\n").collect::<String>();
    fs::write(&log, rows.replacen("t00000", "t", 1)).unwrap();
    audit(&log).stderr(predicate::str::contains("assumed to be ns"));
}

#[test]
fn a_record_of_a_few_intervals_decides_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("short.csv");
    for (stamps, code) in [(3, 1), (20, 1), (21, 0)] {
        let rows: String = (0..stamps).map(|i| format!("{}\n", 0.01 * f64::from(i))).collect();
        fs::write(&log, format!("t\n{rows}")).unwrap();
        let path = log.to_str().unwrap();
        let words = ["10,2", "--period", "0.01", "--jitter-file", path, "--time-unit", "s"];
        let found = libration(&[&ADVISE[..], &words].concat()).code(code);
        let few = format!("the record has {} intervals; expected at least 20", stamps - 1);
        let doubt = predicate::str::contains("Whether the loop is stable is unknown: the record");
        match code {
            0 => found.stdout(doubt.not()),
            _ => found.stdout(doubt).stderr(predicate::str::contains(few)),
        };
    }
}

#[test]
fn time_stamps_in_another_unit_than_the_period_are_an_error_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let log = whole_milliseconds(folder.path());
    let words = [&ADVISE[..], &["10,2", "--period", "0.01", "--jitter-file", &log]].concat();
    libration(&words).code(2).stderr(
        predicate::str::contains(
            "log.csv` (--jitter-file): the mean interval of the record is 1000 times the period",
        )
        .and(predicate::str::contains("--time-unit"))
        .and(predicate::str::contains("skew").not()),
    );
    libration(&[&words[..], &["--time-unit", "ms"]].concat()).success();
}

#[test]
fn options_that_a_log_does_not_take_are_errors() {
    let bag = super::logs::sample("humble.db3");
    let folder = tempfile::tempdir().unwrap();
    let table = whole_milliseconds(folder.path());
    let identify = |log, more: &[&'static str]| {
        let words = ["identify", log, "--command", "cmd", "--response", "q"];
        [&words[..], more].concat()
    };
    let simulate = ["simulate", "--system", "oscillator", "--integrator", "velocity-verlet"];
    let steps = ["--dt", "0.01", "--steps", "3", "--time", "t"];
    let of_bag = "expected no --time; help: --topic and --clock";
    for (words, wanted) in [
        (vec!["clock", &bag, "--time", "t"], of_bag),
        (vec!["clock", &bag, "--time-unit", "ms"], "--time-unit is given"),
        (identify(&bag, &["--time", "t"]), of_bag),
        (vec!["measure-jitter", "--from", &bag, "--time", "t"], of_bag),
        (vec!["clock", &table, "--clock", "header"], "--clock is header"),
        (
            vec!["measure-jitter", "--time", "t"],
            "--time is `t` without a log; help: add --from FILE",
        ),
        ([&simulate[..], &steps].concat(), "without a log; help: add --time-stamps FILE"),
        (vec!["audit", &table, &table, "--energy", "t"], "--energy is `t`, the column of time"),
    ] {
        libration(&words).code(2).stderr(predicate::str::contains(wanted));
    }
}

#[test]
fn identify_reads_each_clock_of_a_bag() {
    let bag = super::logs::sample("humble.db3");
    let identify = |clock: &str| {
        let signals = ["--command", "/joint_states.position[0]", "--response", "/load.newtons"];
        libration(&[&["identify", &bag, "--clock", clock][..], &signals].concat()).code(2)
    };
    identify("publish").stderr(predicate::str::contains(
        "(--command): topic `/joint_states` has no publish times",
    ));
    // The header of the command is read; the response has none.
    identify("header").stderr(predicate::str::contains("(--response)"));
}
