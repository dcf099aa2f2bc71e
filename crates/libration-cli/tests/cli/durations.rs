//! Durations and rates with units, in options and files.

use std::fs;

use super::advise::{json, libration};

const LOOP: [&str; 5] = ["advise", "--system", "oscillator", "--feedback", "10,2"];

#[test]
fn a_period_and_a_latency_with_units_are_those_in_seconds() {
    // Fifty periods are as good as many.
    let short = [&LOOP[..], &["--horizon", "1"]].concat();
    let answer = |words: &[&str]| json(&[&short[..], words].concat());
    let seconds = answer(&["--period", "0.02", "--latency", "0.015"]);
    for words in [
        ["--period", "20ms", "--latency", "15 ms"],
        ["--period", "20000us", "--latency", "15000µs"],
        ["--period", "50Hz", "--latency", "15ms"],
        ["--rate", "50", "--latency", "0.75steps"],
        ["--rate", "0.05 kHz", "--latency", "0.015"],
    ] {
        assert_eq!(answer(&words)["budget"], seconds["budget"], "{words:?}");
    }
    // The command that repeats the answer has the words of the user, those of its parts are in seconds.
    let text = libration(&[&short[..], &["--rate", "50", "--verbose"]].concat()).success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("--rate 50\n") && text.contains("--dt 0.02 "), "{text}");
}

#[test]
fn time_steps_and_horizons_take_units() {
    let analyze = ["analyze", "--system", "oscillator", "--integrator", "velocity-verlet", "--dt"];
    let answer = |dt: &str| json(&[&analyze[..], &[dt]].concat());
    let seconds = answer("0.01");
    for dt in ["10ms", "100Hz", "1e4 us"] {
        assert_eq!(answer(dt), seconds, "{dt}");
    }
}

#[test]
fn texts_that_are_no_durations_are_refused_with_examples() {
    for (words, message) in [
        (["--period", "2 sec"], "also with a unit: 0.002, 2ms or 500Hz"),
        (["--period", "nanms"], "also with a unit"),
        (["--rate", "0"], "expected a rate above 0 in Hz"),
        (["--rate", "2ms"], "expected a rate above 0 in Hz"),
        (["--latency", "500Hz"], "15ms or 1.5steps"),
        (["--horizon", "500Hz"], "also with a unit: 0.002, 2ms or 10min"),
        (["--latency", "-1ms"], "expected a finite number of at least 0"),
    ] {
        let failed = libration(&[&LOOP[..], &words].concat()).code(2);
        let said = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(said.contains(message), "{words:?}: {said}");
    }
    let both = [&LOOP[..], &["--period", "2ms", "--rate", "500"]].concat();
    libration(&both).code(2);
    let lone = libration(&["advise", "--system", "oscillator", "--rate", "500"]).code(2);
    assert!(
        String::from_utf8_lossy(&lone.get_output().stderr)
            .contains("--rate is given, but there is no loop")
    );
    libration(&["measure-jitter", "--rate", "0.5 kHz", "--seconds", "50ms"]).success();
    // The unit of time of bodies is their own.
    let bodies =
        ["bodies", "figure-eight", "--integrator", "leapfrog", "--steps", "9", "--dt", "1ms"];
    libration(&bodies).code(2);
}

#[test]
fn files_take_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("loop.toml");
    let plant = "[system.linear]\na = [[0, 1], [0, 0]]\nb = [[0], [1]]\n[controller.lqr]\nstates = [1, 0]\ninputs = [1]\n";
    let system = "[system.oscillator]\nomega2 = 10\n[controller.pd]\nposition = 10\nvelocity = 2\n[request]\nhorizon = HORIZON\n";
    for (text, each) in [(plant, "[\"15 ms\"]"), (system, "\"15ms\"")] {
        let write = |period: &str, latency: &str, horizon: &str| {
            let text = text.replace("HORIZON", horizon);
            let looped = format!("{text}[loop]\nperiod = {period}\nlatency = {latency}\n");
            fs::write(&path, looped).unwrap();
            ["advise", "--config", path.to_str().unwrap()]
        };
        let answer = |words: [&str; 3]| {
            let mut answer = json(&words);
            // It is measured.
            answer.as_object_mut().unwrap().remove("throughput");
            answer
        };
        let seconds = answer(write("0.02", "0.015", "0.1"));
        assert_eq!(answer(write("\"20ms\"", each, "\"0.1s\"")), seconds);
        assert_eq!(answer(write("\"50Hz\"", each, "\"100ms\"")), seconds);
        for (period, latency) in [("\"2 sec\"", "0"), ("0.002", "\"fast\""), ("0.002", "\"500Hz\"")]
        {
            let failed = libration(&write(period, latency, "0.1")).code(2);
            let said = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
            assert!(said.contains("loop.toml") && said.contains("2ms"), "{said}");
        }
    }
}

#[test]
fn lags_filters_and_periods_of_plants_take_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("loop.toml");
    let answer = |text: &str| {
        fs::write(&path, text).unwrap();
        let mut answer = json(&["advise", "--config", path.to_str().unwrap()]);
        answer.as_object_mut().unwrap().remove("throughput");
        answer
    };
    let plant = "[system.linear]\na = [[0, 1], [0, 0]]\nb = [[0], [1]]\n[controller.lqr]\nstates = [1, 0]\ninputs = [1]\n[loop]\nperiod = 0.1\n[[part]]\nlag = LAG\ninput = \"u1\"\n";
    let sampled = "[system.linear]\na = [[1, 0.1], [0, 1]]\nb = [[0.005], [0.1]]\nsampling-period = PERIOD\n[controller.lqr]\nstates = [1, 0]\ninputs = [1]\n";
    let pid = "[system.oscillator]\nomega2 = 10\n[controller.pid]\nproportional = 10\nintegral = 1\nderivative = 2\nfilter = FILTER\n[loop]\nperiod = 0.1\n";
    for (text, name, number, with_unit) in [
        (plant, "LAG", "0.012", "\"12ms\""),
        (sampled, "PERIOD", "0.1", "\"10Hz\""),
        (pid, "FILTER", "0.05", "\"50 ms\""),
    ] {
        assert_eq!(
            answer(&text.replace(name, with_unit)),
            answer(&text.replace(name, number)),
            "{name}"
        );
    }
}
