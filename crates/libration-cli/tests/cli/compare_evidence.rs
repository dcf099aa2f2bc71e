//! A result of `libration compare` that was not compared is no success.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::compare::{compared, results};

type Edit<'a> = &'a dyn Fn(&mut Value);

/// Compares results with three findings, each file after an edit.
fn edited([before, after]: [Edit<'_>; 2], code: i32) -> String {
    let folder = tempfile::tempdir().unwrap();
    let first = results(folder.path(), "first", [1.0, 1e9, 0.5], "agrees");
    let text = fs::read_to_string(first.join("results.json")).unwrap();
    let written = |name: &str, edit: Edit<'_>| {
        let mut all: Value = serde_json::from_str(&text).unwrap();
        edit(&mut all);
        let file = folder.path().join(name);
        fs::write(&file, all.to_string()).unwrap();
        file
    };
    let files = [written("before.json", before), written("after.json", after)];
    let paths: Vec<&str> = files.iter().map(|file| Path::to_str(file).unwrap()).collect();
    compared(&paths, code)
}

fn kept(_: &mut Value) {}

fn findings(all: &mut Value) -> &mut Vec<Value> {
    all["studies"][0]["findings"].as_array_mut().unwrap()
}

#[test]
fn results_without_a_common_finding_are_unknown() {
    let other_effort = |all: &mut Value| {
        all["config"]["effort"] = json!("full");
        findings(all).clear();
    };
    let other_study = |all: &mut Value| {
        all["config"]["studies"] = json!(["clock"]);
        all["studies"] = json!([]);
    };
    let empty = |all: &mut Value| all["studies"] = json!([]);
    let other_units =
        |all: &mut Value| findings(all).iter_mut().for_each(|one| one["unit"] = json!("m"));
    // Each but the rate, which may have fallen in another unit.
    let other_measures = |all: &mut Value| {
        findings(all).remove(1);
        other_units(all);
    };
    let without_rate = |all: &mut Value| drop(findings(all).remove(1));
    let no_numbers =
        |all: &mut Value| findings(all).iter_mut().for_each(|one| one["measured"] = Value::Null);
    for edits in [
        [&kept as Edit<'_>, &other_effort],
        [&kept, &other_study],
        [&empty, &empty],
        [&empty, &kept],
        [&without_rate, &other_measures],
        [&no_numbers, &no_numbers],
    ] {
        let said = edited(edits, 1);
        assert!(said.starts_with("unknown: no finding was compared;"), "{said}");
        assert!(said.contains("error: no finding was compared"), "{said}");
    }
    let said = edited([&kept, &other_effort], 1);
    assert!(said.contains("(not examined: 3 findings of the first run alone)"), "{said}");
    // One finding in common is enough, and the verdict names the rest.
    let one = |all: &mut Value| {
        all["config"]["effort"] = json!("full");
        findings(all).truncate(1);
    };
    let said = edited([&kept, &one], 0);
    assert!(said.starts_with("no fault: nothing became worse; 1 finding is the same"), "{said}");
    assert!(said.contains("(not examined: 2 findings of the first run alone)"), "{said}");
}

/// Sets keys of the first finding, which is measured as 1 and predicted as 1 within 0.001.
fn first_with(keys: Value) -> impl Fn(&mut Value) {
    move |all| {
        for (key, value) in keys.as_object().unwrap() {
            findings(all)[0][key] = value.clone();
        }
    }
}

#[test]
fn a_prediction_that_moves_with_the_measurement_fails_the_comparison() {
    for (before, after, said_of) in [
        (json!({}), json!({ "measured": 5, "predicted": 5 }), "from 1 to 5"),
        (json!({}), json!({ "measured": 1.2, "predicted": 1.2 }), "from 1 to 1.2"),
        (json!({}), json!({ "measured": 5, "predicted": 5, "tolerance": 1e9 }), "from 1 to 5"),
        (json!({}), json!({ "measured": 5, "predicted": 5, "relation": "at-most" }), "from 1 to 5"),
        (json!({}), json!({ "measured": 5, "predicted": null }), "from 1 to none"),
        // Theory that is moved to a measurement that disagreed.
        (
            json!({ "measured": 1.5, "verdict": "disagrees" }),
            json!({ "measured": 1.5, "predicted": 1.5 }),
            "from 1 to 1.5",
        ),
        // A bound that is lowered with what it bounds.
        (
            json!({ "relation": "at-least" }),
            json!({ "relation": "at-least", "measured": 0.2, "predicted": 0.1 }),
            "from 1 to 0.1",
        ),
    ] {
        let said = edited([&first_with(before), &first_with(after)], 1);
        assert!(said.contains(&format!("prediction changed {said_of}: ")), "{said}");
        assert!(said.contains("error: the prediction of a finding changed"), "{said}");
    }
    // Within the tolerances, with other settings, and in a study that may predict from measurements.
    edited([&kept, &first_with(json!({ "measured": 1.0015, "predicted": 1.0015 }))], 0);
    let other = |all: &mut Value| {
        first_with(json!({ "measured": 1.2, "predicted": 1.2 }))(all);
        all["config"]["effort"] = json!("full");
    };
    let said = edited([&kept, &other], 0);
    assert!(said.contains("prediction changed from 1 to 1.2"), "{said}");
    let machine = |value: f64| {
        first_with(json!({ "id": "throughput.one", "measured": value, "predicted": value }))
    };
    edited([&machine(1.0), &machine(1.2)], 0);
    // A wider tolerance makes no finding better.
    let wide = first_with(json!({ "measured": 1.5, "tolerance": 1.0 }));
    let said = edited([&first_with(json!({ "measured": 1.5, "verdict": "disagrees" })), &wide], 0);
    assert!(said.contains("1 disagrees with theory in both"), "{said}");
    assert!(said.contains("disagreed with theory at 1.5, as now"), "{said}");
}

#[test]
fn an_unfinished_second_run_fails_the_comparison() {
    let set = |complete: bool| move |all: &mut Value| all["complete"] = json!(complete);
    for first in [&kept as Edit<'_>, &set(true)] {
        let said = edited([first, &set(false)], 1);
        let reason = "the first run is complete, the second is not";
        assert!(said.starts_with(&format!("fault: {reason}; 3 findings are the same")), "{said}");
        assert!(said.contains("(not examined: the rest of the second run)"), "{said}");
    }
    let said = edited([&set(false), &set(false)], 0);
    assert!(said.contains("(not examined: the rest of both runs)"), "{said}");
    edited([&set(false), &set(true)], 0);
}

#[test]
fn a_finding_that_is_judged_and_undecided_is_misstated_in_either_file() {
    let undecided = first_with(json!({ "undecided": "too noisy" }));
    let disagrees = first_with(json!({ "undecided": "too noisy", "verdict": "disagrees" }));
    let new = |all: &mut Value| {
        let mut own = findings(all)[0].clone();
        own["id"] = json!("drift.new");
        own["undecided"] = json!("too noisy");
        findings(all).push(own);
    };
    for (edits, id) in [
        ([&kept as Edit<'_>, &undecided as Edit<'_>], "drift.largest"),
        ([&undecided, &kept], "drift.largest"),
        ([&undecided, &undecided], "drift.largest"),
        ([&disagrees, &disagrees], "drift.largest"),
        ([&kept, &new], "drift.new"),
    ] {
        let said = edited(edits, 1);
        let reason = format!("fault: judged and undecided at once: {id};");
        assert!(said.starts_with(&reason), "{said}");
    }
    // This is the file that a run writes.
    let keys = json!({ "undecided": "too noisy", "verdict": "measured", "predicted": null });
    let said = edited([&kept, &first_with(keys)], 0);
    assert!(said.contains("1 finding that the second run left undecided"), "{said}");
}

#[test]
fn an_identifier_that_occurs_twice_in_a_file_is_refused_in_any_order() {
    let bad = |all: &Value| {
        let mut own = all["studies"][0]["findings"][0].clone();
        own["measured"] = json!(5.0);
        own["verdict"] = json!("disagrees");
        own
    };
    let last = |all: &mut Value| {
        let own = bad(all);
        findings(all).push(own);
    };
    let first = |all: &mut Value| {
        let own = bad(all);
        findings(all).insert(0, own);
    };
    let study = |all: &mut Value| {
        let own = all["studies"][0].clone();
        all["studies"].as_array_mut().unwrap().push(own);
    };
    let claims = |all: &mut Value| {
        let claim = |verdict: &str| {
            json!({
                "id": "C07", "source": "2.1", "text": "?", "verdict": verdict, "condition": null, "because": "",
                "findings": []
            })
        };
        all["studies"][0]["claims"] = json!([claim("refuted"), claim("confirmed")]);
    };
    for (edit, what) in [
        (&last as Edit<'_>, "the finding `drift.largest` occurs twice"),
        (&first, "the finding `drift.largest` occurs twice"),
        (&study, "the finding `drift.largest` occurs twice"),
        (&claims, "the claim `C07` occurs twice"),
    ] {
        let said = edited([&kept, edit], 2);
        assert!(said.contains("after.json") && said.contains(what), "{said}");
        let said = edited([edit, &kept], 2);
        assert!(said.contains("before.json") && said.contains(what), "{said}");
    }
}
