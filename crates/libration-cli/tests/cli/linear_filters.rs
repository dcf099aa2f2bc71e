//! Filters of samples and clocks of loops around linear plants, through the binary.

use std::fs;

use predicates::prelude::*;
use serde_json::Value;

use super::advise::{json, libration};
use super::linear::{OSCILLATOR, example, written};

#[test]
fn a_filter_of_samples_stands_in_the_chain_and_a_design_that_does_not_know_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let part = "[[part]]\nname = \"mean\"\noutput = \"x2\"\nmoving-average = 5\n[controller.lqr]\nstates = [10, 1]\ninputs = [0.1]";
    let text = OSCILLATOR.replace("[controller.state-feedback]\ngain = [[10, 2]]", part);
    let path = written(&folder, "filtered.toml", &text);
    let advice = json(&["advise", "--config", path.to_str().unwrap()]);
    let controller = advice["controller"].as_str().unwrap();
    assert!(controller.ends_with("; the design does not know mean"), "{controller}");
    // Four samples are remembered, and the mean delays by two periods of 10 ms.
    assert_eq!(advice["controller_matrices"]["a"].as_array().unwrap().len(), 4);
    let link = &advice["chain"][0];
    assert_eq!(link["part"], "mean");
    assert!((link["delay"].as_f64().unwrap() - 0.02).abs() < 1e-15, "{link}");
    let frequency = -link["phase"].as_f64().unwrap() / 360.0 / 0.02;
    let hold = advice["chain"].as_array().unwrap().last().unwrap();
    let wanted = -hold["phase"].as_f64().unwrap() / 360.0 / 0.005;
    // Each has the frequency of the limit of its own channel, and both are near the crossover.
    let crossover = advice["margins"][0]["crossover"].as_f64().unwrap();
    for found in [frequency, wanted] {
        assert!((0.9..1.1).contains(&(found / crossover)), "{found} {crossover}");
    }
}

#[test]
fn a_measured_clock_is_for_controllers_of_one_rate() {
    let folder = tempfile::tempdir().unwrap();
    let own = fs::read_to_string(example("cascade.toml")).unwrap();
    for (clock, words) in [("measured", "the controller is a cascade"), ("right", "unknown value")]
    {
        let text = own.replace("[loop]\n", &format!("[loop]\nclock = \"{clock}\"\n"));
        let path = written(&folder, "clock.toml", &text);
        libration(&["advise", "--config", path.to_str().unwrap()])
            .code(2)
            .stderr(predicate::str::contains(words));
    }
}

#[test]
fn a_part_that_is_ten_orders_faster_than_the_period_changes_no_limit() {
    let folder = tempfile::tempdir().unwrap();
    let advice = |part: &str| {
        let text = OSCILLATOR.replace("[controller", &format!("{part}\n[controller"));
        let path = written(&folder, "fast.toml", &text);
        json(&["advise", "--config", path.to_str().unwrap()])
    };
    let without = advice("");
    for part in ["lag = 1e-12", "butterworth2 = 1e10"] {
        let with = advice(&format!("[[part]]\ninput = \"u1\"\n{part}"));
        let limits = |advice: &Value| -> Vec<Option<f64>> {
            let budgets = advice["budgets"].as_array().unwrap();
            budgets.iter().map(|budget| budget["stable_up_to"].as_f64()).collect()
        };
        for (fast, none) in limits(&with).into_iter().zip(limits(&without)) {
            // A latency is shorter by the delay of the part, 10⁻¹² s, 10⁻¹⁰ of a period.
            let close = match (fast, none) {
                (Some(fast), Some(none)) => (fast - none).abs() < 1e-9,
                (fast, none) => fast == none,
            };
            assert!(close, "{part}: {fast:?} {none:?}");
        }
    }
}
