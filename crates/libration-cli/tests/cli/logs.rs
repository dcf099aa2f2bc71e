//! `libration clock`, and logs wherever time stamps are taken, through the binary.

use std::fs;

use predicates::prelude::*;
use serde_json::Value;

use super::advise::{ADVISE, json, libration};

/// A log that the packages `mcap` and `mcap-ros2-support` wrote.
pub(crate) fn sample(name: &str) -> String {
    format!("{}/../libration-logs/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// A loop of a hundred hertz, as the sample has one.
const LOOP: &str = "\
[system.oscillator]\nomega2 = 10.0\n\n[controller.pd]\nposition = 10.0\nvelocity = 2.0\n\n[loop]\nperiod = 0.01\n";

#[test]
fn the_topics_of_a_bag_are_listed() {
    let found = json(&["clock", &sample("zstd.mcap")]);
    let names: Vec<_> = found["topics"]
        .as_array()
        .unwrap()
        .iter()
        .map(|topic| topic["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["/joint_states", "/cmd", "/statistics"]);
    assert_eq!(found["topics"][0]["clocks"].as_array().unwrap().len(), 3);
    let text = libration(&["clock", &sample("truncated.mcap")]).success();
    text.stdout(predicate::str::contains("note: the end of the file is missing"));
}

#[test]
fn latency_drift_and_phase_of_two_topics_are_those_that_were_written() {
    let found =
        json(&["clock", &sample("zstd.mcap"), "--topic", "/joint_states", "--against", "/cmd"]);
    let latency = &found["latency"];
    assert_eq!(latency["matching"], "header-stamps");
    assert_eq!((&latency["count"], &latency["unanswered"]), (&144.into(), &16.into()));
    // Uniform from 3 to 5 ms; 144 draws have a mean within four deviations of 0.58 / 12 ms.
    let mean = latency["mean"].as_f64().unwrap();
    assert!((mean - 4e-3).abs() < 4.0 * 0.58e-3 / 12.0, "{mean}");
    assert_eq!(latency["law"]["fits"][0]["name"], "uniform");
    let lag = &latency["phase_of_99_percent"][0];
    let last = latency["quantiles"].as_array().unwrap().iter().find(|q| q["part"] == 0.99).unwrap();
    assert_eq!(lag["degrees"].as_f64(), last["value"].as_f64().map(|x| 360.0 * x));
    assert_eq!(found["clock"]["backward"], 2);
    assert!(found["clock"]["log_against_header"]["skew_ppm"].is_f64());
    let command = found["advise_command"].as_str().unwrap();
    assert!(command.contains("--topic /joint_states --latency 0.0049"), "{command}");
}

#[test]
fn a_loop_is_told_what_its_recorded_clock_does() {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("loop.toml");
    fs::write(&config, LOOP).unwrap();
    let config = config.to_str().unwrap();
    let bag = sample("zstd.mcap");
    let page = folder.path().join("clock.html");
    let words =
        ["clock", &bag, "--topic", "/joint_states", "--against", "/cmd", "--config", config];
    let found = json(&[&words[..], &["--page", page.to_str().unwrap()]].concat());
    let effects = found["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 2);
    for effect in effects {
        assert_eq!(effect["holds"], true);
        let budgets = effect["budgets"].as_array().unwrap();
        let of = |kind: &str| budgets.iter().find(|budget| budget["kind"] == kind).unwrap();
        assert_eq!(
            of("latency")["stated"].as_f64().map(|x| (1e3 * x).round()),
            effect["latency"].as_f64().map(|x| (1e3 * x).round())
        );
        // The jitter is that of the record.
        let rms = found["clock"]["statistics"]["jitter_rms"].as_f64().unwrap();
        assert!((of("jitter")["stated"].as_f64().unwrap() - rms).abs() < 1e-9);
    }
    assert!(fs::read_to_string(&page).unwrap().contains("Distribution of the latency"));
    // The same command on its own has the same answer.
    let command = effects[1]["command"].as_str().unwrap();
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    assert_eq!(json(&words)["answer"], effects[1]["answer"]);
}

#[test]
fn logs_are_taken_wherever_time_stamps_are() {
    let bag = sample("zstd.mcap");
    let words = [
        &ADVISE[..],
        &[
            "10,2",
            "--period",
            "0.01",
            "--jitter-file",
            &bag,
            "--topic",
            "/joint_states",
            "--clock",
            "header",
        ],
    ]
    .concat();
    let advised = json(&words);
    let statistics =
        json(&["measure-jitter", "--from", &bag, "--topic", "joint_states", "--clock", "header"]);
    let stated = advised["loop"]["budgets"][1]["stated"].as_f64().unwrap();
    assert!((stated - statistics["jitter_rms"].as_f64().unwrap()).abs() < 1e-9, "{stated}");
    for (name, topic) in [
        ("px4.ulg", "rate"),
        ("ros1.bag", "/joint_states"),
        ("table.npz", "stamp"),
        ("table.parquet", "stamp"),
    ] {
        libration(&["measure-jitter", "--from", &sample(name), "--topic", topic]).success();
    }
    // One topic, or a column of time, needs no option.
    for name in ["ros1_lz4.bag", "table.npz", "table.parquet", "matrix.npy"] {
        libration(&["measure-jitter", "--from", &sample(name)]).success();
    }
    let steps = ["--integrator", "rk4", "--dt", "0.01", "--steps", "20", "--system", "oscillator"];
    let words = [&["simulate", "--time-stamps", &bag, "--topic", "/cmd"], &steps[..]].concat();
    libration(&words).success();
}

#[test]
fn the_column_of_time_and_its_unit_reach_every_command_that_takes_time_stamps() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("table.csv");
    let rows: Vec<String> = (0..40).map(|i| format!("{i},{}\n", 2500 * i)).collect();
    fs::write(&table, format!("k,ticks\n{}", rows.concat())).unwrap();
    let table = table.to_str().unwrap();
    let time = ["--time", "ticks", "--time-unit", "us"];
    let found = json(&[&["clock", table][..], &time].concat());
    let mean = |statistics: &Value| statistics["mean"].as_f64().unwrap();
    assert!((mean(&found["clock"]["statistics"]) - 2.5e-3).abs() < 1e-12, "{found}");
    let measured = json(&[&["measure-jitter", "--from", table][..], &time].concat());
    assert!((mean(&measured) - 2.5e-3).abs() < 1e-12, "{measured}");
    // What `clock` prints has the options.
    let config = folder.path().join("loop.toml");
    fs::write(&config, LOOP.replace("0.01", "0.0025")).unwrap();
    let config = config.to_str().unwrap();
    let found = json(&[&["clock", table, "--config", config][..], &time].concat());
    let effect = &found["effects"][0];
    for command in [&found["advise_command"], &effect["command"]] {
        assert!(command.as_str().unwrap().contains(&time.join(" ")), "{command}");
    }
    let command = effect["command"].as_str().unwrap();
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    assert_eq!(json(&words)["answer"], effect["answer"]);
    let steps = ["--integrator", "rk4", "--dt", "0.0025", "--steps", "3", "--system", "oscillator"];
    let words = [&["simulate", "--time-stamps", table][..], &time, &steps].concat();
    let rows = libration(&words).success();
    rows.stdout(predicate::str::contains("\n3,0.0075,"));
    let words = ["advise", "--config", config, "--time-unit", "us"];
    let wrong = predicate::str::contains("--time-unit is `us` without a log");
    libration(&words).code(2).stderr(wrong);
}

#[test]
fn wrong_input_names_the_option_the_value_and_what_is_allowed() {
    let bag = sample("zstd.mcap");
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("loop.toml");
    fs::write(&config, LOOP).unwrap();
    let noise = folder.path().join("noise");
    fs::write(&noise, [0_u8, 1, 2, 3]).unwrap();
    let cases: [(&[&str], &str); 10] = [
        (
            &["clock", &bag, "--topic", "/cmds"],
            "(--topic): the file has no topic `/cmds`; expected one of `/joint_states`, `/cmd`",
        ),
        (
            &["clock", &bag, "--topic", "/cmd", "--against", "/no"],
            "(--against): the file has no topic `/no`",
        ),
        (&["clock", &bag, "--topic", "/statistics", "--clock", "publish"], "has no publish times"),
        (&["clock", &bag, "--against", "/cmd"], "--topic"),
        (
            &["clock", &bag, "--config", config.to_str().unwrap()],
            "expected --topic with one of `/joint_states`",
        ),
        (
            &["clock", &bag, "--topic", "/cmd", "--against", "/cmd"],
            "(--against): both topics are `/cmd`",
        ),
        (
            &["advise", "--config", config.to_str().unwrap(), "--topic", "/cmd"],
            "--topic is `/cmd` without a log",
        ),
        (&["clock", noise.to_str().unwrap()], "the format is unknown; expected MCAP"),
        (
            &["clock", &sample("table.npz"), "--time", "tim"],
            "(--time): the file has no column `tim`",
        ),
        (
            &["measure-jitter", "--from", &bag],
            "(--from): it has 3 topics; expected --topic with one of",
        ),
    ];
    for (words, wanted) in cases {
        libration(words).code(2).stderr(predicate::str::contains(wanted));
    }
}

/// Writes stamps in ns, one in 10 ms, and later ones: 1 ms with up to 0.2 ms more, and `rise` ns more from row to row.
fn two_stamps(folder: &std::path::Path, rise: i64) -> String {
    let mut word = 7_u32;
    let mut row = |n: i64| {
        word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let start = 1_700_000_000_000_000_000 + 10_000_000 * n;
        format!("{start},{}\n", start + 1_000_000 + i64::from(word >> 8) / 84 + rise * n)
    };
    let rows: String = (0..1000).map(&mut row).collect();
    let path = folder.join("stamps.csv");
    fs::write(&path, format!("start_ns,end_ns\n{rows}")).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn latencies_of_clocks_that_drift_have_a_slope_and_neither_a_law_nor_a_proposal() {
    let folder = tempfile::tempdir().unwrap();
    let clock = |rise: i64| {
        let log = two_stamps(folder.path(), rise);
        json(&["clock", &log, "--topic", "start_ns", "--against", "end_ns"])
    };
    let found = clock(200);
    let trend = &found["latency"]["time_dependence"]["trend"];
    let [slope, width] = ["skew_ppm", "half_width_ppm"].map(|key| trend[key].as_f64().unwrap());
    // 200 ns in 10 ms. Noise of 58 µs rms over 10 s leaves 0.6 ppm.
    assert!((slope - 20.0).abs() < 2.0 * width && width < 2.5, "{trend}");
    assert_eq!(found["latency"]["law"]["verdict"], "depends-on-time");
    assert_eq!(found["latency"]["law"]["fits"].as_array().unwrap().len(), 0);
    assert!(!found["advise_command"].as_str().unwrap().contains("--latency"));
    // Without drift there is both.
    let found = clock(0);
    assert_eq!(found["latency"]["law"]["fits"][0]["name"], "uniform");
    assert!(found["advise_command"].as_str().unwrap().contains("--latency 0.001"));
    let log = two_stamps(folder.path(), 200);
    let config = folder.path().join("loop.toml");
    fs::write(&config, LOOP).unwrap();
    let words = ["clock", &log, "--topic", "start_ns", "--against", "end_ns", "--config"];
    libration(&[&words[..], &[config.to_str().unwrap()]].concat())
        .code(1)
        .stdout(predicate::str::contains("verdict: unknown: the latencies change over time"));
}

#[test]
fn a_record_that_is_not_the_clock_of_the_loop_decides_nothing_on_any_page() {
    let folder = tempfile::tempdir().unwrap();
    let log = two_stamps(folder.path(), 0);
    // The record has a stamp in 10 ms, the loop a period of 20 ms.
    let config = folder.path().join("loop.toml");
    fs::write(&config, LOOP.replace("0.01", "0.02")).unwrap();
    let config = config.to_str().unwrap();
    let page = folder.path().join("clock.html");
    let warning = "the mean interval of the record is 10.0 ms, the period of the loop 20.0 ms: the record is not the clock of this loop";
    let unknown =
        "Whether the loop is stable is unknown: the record is not the clock of this loop.";
    let words = ["clock", &log, "--topic", "start_ns", "--config", config, "--page"];
    libration(&[&words[..], &[page.to_str().unwrap()]].concat()).code(1).stdout(
        predicate::str::contains(warning)
            .and(predicate::str::contains("verdict: unknown: the record is not the clock"))
            .and(predicate::str::contains(format!(
                "recorded clock, latency of the file: {unknown}"
            )))
            .and(predicate::str::contains("relative rms; limit: ")),
    );
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.contains(warning) && text.contains("Loop with a recorded clock: unknown"));
    // `advise` with the same record has the same verdict, exit code and first sentence.
    let unknown_json = |words: &[&str]| -> Value {
        let output = libration(&[words, &["--json"]].concat()).code(1);
        serde_json::from_slice(&output.get_output().stdout).unwrap()
    };
    let found = unknown_json(&words[..6]);
    let words = ["advise", "--config", config, "--jitter-file", &log, "--time", "start_ns"];
    let advised = unknown_json(&words);
    let effect = &found["effects"][0];
    assert_eq!((&effect["verdict"], &effect["holds"]), (&advised["verdict"], &Value::Bool(false)));
    for answer in [&effect["answer"], &advised["answer"]] {
        assert!(answer.as_str().unwrap().starts_with(unknown), "{answer}");
    }
    libration(&words).code(1).stdout(predicate::str::starts_with("Whether the loop is stable is"));
    let warnings = advised["warnings"].to_string();
    assert!(warnings.contains("the record is not the clock of this loop"), "{warnings}");
}
