//! `libration compare`.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::advise::libration;

/// Writes results with three findings: of theory, of a speed, and of another measurement.
pub(super) fn results(
    folder: &Path,
    name: &str,
    [drift, rate, share]: [f64; 3],
    verdict: &str,
) -> PathBuf {
    let finding = |id: &str, unit: &str, measured: f64, predicted: Value, verdict: &str| {
        let tolerance = if predicted.is_null() { Value::Null } else { json!(1e-3) };
        json!({
            "id": id, "text": "something", "unit": unit, "predicted": predicted, "measured": measured,
            "relation": "equal", "tolerance": tolerance, "tolerance_reason": "rounding",
            "verdict": verdict, "undecided": null
        })
    };
    let findings = [
        finding("drift.largest", "1", drift, json!(1.0), verdict),
        finding("rollout.rate", "1/s", rate, Value::Null, "measured"),
        finding("rollout.share", "1", share, Value::Null, "measured"),
    ];
    let study = json!({
        "name": "drift", "question": "?", "seconds": 1.0, "findings": findings, "claims": [], "tables": [],
        "figures": [], "data": []
    });
    let all = json!({
        "schema": "libration.results/1", "machine": { "version": name }, "config": { "effort": "quick" },
        "studies": [study]
    });
    let folder = folder.join(name);
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("results.json"), all.to_string()).unwrap();
    folder
}

pub(super) fn compared(words: &[&str], code: i32) -> String {
    let done = libration(&[&["compare"], words].concat()).code(code);
    let output = done.get_output();
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

#[test]
fn findings_that_became_worse_fail_the_comparison_and_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str, numbers: [f64; 3], verdict: &str| {
        results(folder.path(), name, numbers, verdict).to_str().unwrap().to_owned()
    };
    let first = path("first", [1.0, 1e9, 0.5], "agrees");
    let near = path("near", [1.0005, 0.9e9, 0.55], "agrees");
    let said = compared(&[&first, &near], 0);
    assert!(said.contains("0 findings are the same, 3 within"), "{said}");
    assert!(said.contains("machine.version differs: \"first\", then \"near\""), "{said}");
    // A verdict that the numbers do not give.
    let left = path("left", [1.1, 1e9, 0.5], "agrees");
    let said = compared(&[&first, &left], 1);
    assert!(said.contains("agreed with theory at 1, now disagrees: measured 1.1"), "{said}");
    // A tolerance that was widened until the measurement fits.
    let wide = path("wide", [1.1, 1e9, 0.5], "agrees");
    let file = Path::new(&wide).join("results.json");
    let mut all: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    all["studies"][0]["findings"][0]["tolerance"] = json!(1.0);
    fs::write(&file, all.to_string()).unwrap();
    let said = compared(&[&first, &wide], 1);
    assert!(said.contains("now disagrees: measured 1.1, predicted 1, tolerance 0.001"), "{said}");
    // A prediction that nobody checks any more, unless the study was not asked for.
    let lost = path("lost", [1.0, 1e9, 0.5], "agrees");
    let file = Path::new(&lost).join("results.json");
    let mut all: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    all["studies"][0]["findings"].as_array_mut().unwrap().remove(0);
    fs::write(&file, all.to_string()).unwrap();
    let said = compared(&[&first, &lost], 1);
    assert!(said.contains("a finding of the first run missing in the second"), "{said}");
    all["config"]["studies"] = json!(["rollout"]);
    fs::write(&file, all.to_string()).unwrap();
    compared(&[&first, &lost], 0);
    let said = compared(&[&first, &first], 0);
    assert!(
        said.contains("3 findings are the same, 0 within") && !said.contains("differs"),
        "{said}"
    );
    let wrong = path("wrong", [1.5, 1e9, 0.5], "disagrees");
    let said = compared(&[&first, &wrong], 1);
    assert!(
        said.contains(
            "agreed with theory at 1, now disagrees: measured 1.5, predicted 1, tolerance 0.001"
        ),
        "{said}"
    );
    assert!(said.contains("a finding became worse"), "{said}");
    let said = compared(&[&wrong, &first], 0);
    assert!(said.contains("better\n  drift.largest"), "{said}");
    let slow = path("slow", [1.0, 0.7e9, 0.5], "agrees");
    let said = compared(&[&first, &slow], 1);
    assert!(
        said.contains("worse\n  rollout.rate\n    1000000000 1/s, then 700000000 1/s, 0.7 times"),
        "{said}"
    );
    compared(&[&first, &slow, "--noise", "0.31"], 0);
    // Nobody knows whether more of it is better.
    let other = path("other", [1.0, 1e9, 0.2], "agrees");
    let said = compared(&[&first, &other], 0);
    assert!(said.contains("different\n  rollout.share"), "{said}");
}

#[test]
fn a_comparison_as_json_has_all_that_differs() {
    let folder = tempfile::tempdir().unwrap();
    let first = results(folder.path(), "first", [1.0, 1e9, 0.5], "agrees");
    let file = first.join("results.json");
    let mut shorter: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    shorter["studies"][0]["findings"].as_array_mut().unwrap().remove(0);
    shorter["config"]["studies"] = json!(["rollout"]);
    let second = folder.path().join("second.json");
    fs::write(&second, shorter.to_string()).unwrap();
    let said = compared(&[file.to_str().unwrap(), second.to_str().unwrap(), "--json"], 0);
    let said: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["schema"], "libration.compare/1");
    assert_eq!((&said["same"], &said["only_before"]), (&json!(2), &json!(["drift.largest"])));
    assert_eq!((&said["compared"], &said["verdict"]["outcome"]), (&json!(2), &json!("no-fault")));
    let rest = json!(["1 finding of the first run alone"]);
    assert_eq!(said["verdict"]["not_examined"], rest);
}

#[test]
fn another_verdict_prediction_or_unit_is_not_the_same_finding() {
    let folder = tempfile::tempdir().unwrap();
    let first = results(folder.path(), "first", [1.0, 1e9, 0.5], "agrees");
    let text = fs::read_to_string(first.join("results.json")).unwrap();
    let second = folder.path().join("second.json");
    let changed = |key: &str, value: Value| {
        let mut all: Value = serde_json::from_str(&text).unwrap();
        all["studies"][0]["findings"][0][key] = value;
        fs::write(&second, all.to_string()).unwrap();
    };
    let paths = [first.to_str().unwrap(), second.to_str().unwrap()];
    for (key, value, title, code) in [
        ("verdict", json!("measured"), "worse\n  drift.largest\n    no longer has a prediction", 1),
        (
            "unit",
            json!("m"),
            "different\n  drift.largest\n    1, then 1 m, which are not compared",
            0,
        ),
        ("relation", json!("at-most"), "different\n  drift.largest", 0),
    ] {
        changed(key, value);
        let said = compared(&paths, code);
        assert!(said.contains(title) && said.contains("2 findings are the same"), "{key}: {said}");
    }
    changed("predicted", json!(5.0));
    let said = compared(&paths, 1);
    assert!(said.contains("now disagrees: measured 1, predicted 5"), "{said}");
    // What disagrees and was not there before, and a rate that is missing.
    let mut all: Value = serde_json::from_str(&text).unwrap();
    all["studies"][0]["findings"][0]["id"] = json!("drift.new");
    all["studies"][0]["findings"][0]["verdict"] = json!("disagrees");
    all["studies"][0]["findings"][1]["measured"] = Value::Null;
    all["complete"] = json!(false);
    fs::write(&second, all.to_string()).unwrap();
    let said = compared(&paths, 1);
    for part in [
        "drift.new\n    disagrees with theory: measured 1, predicted 1",
        "rollout.rate\n    1000000000 1/s, then no number",
        "complete differs: true, then false",
        "2 findings became worse, a finding of the first run missing in the second",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn a_weaker_relation_does_not_make_a_measurement_agree() {
    let folder = tempfile::tempdir().unwrap();
    let first = results(folder.path(), "first", [1.0, 1e9, 0.5], "agrees");
    let text = fs::read_to_string(first.join("results.json")).unwrap();
    let second = folder.path().join("second.json");
    for (relation, measured, code) in
        [("at-least", 1e9, 1), ("at-most", -1e9, 1), ("at-least", 1.0, 0), ("equal", 1.0, 0)]
    {
        let mut all: Value = serde_json::from_str(&text).unwrap();
        all["studies"][0]["findings"][0]["relation"] = json!(relation);
        all["studies"][0]["findings"][0]["measured"] = json!(measured);
        fs::write(&second, all.to_string()).unwrap();
        let said = compared(&[first.to_str().unwrap(), second.to_str().unwrap()], code);
        assert_eq!(said.contains("now disagrees"), code == 1, "{relation} {measured}: {said}");
    }
}

#[test]
fn claims_that_lose_their_verdict_fail_the_comparison() {
    let folder = tempfile::tempdir().unwrap();
    let first = results(folder.path(), "first", [1.0, 1e9, 0.5], "agrees");
    let text = fs::read_to_string(first.join("results.json")).unwrap();
    let claim = |verdict: &str| {
        json!([{
            "id": "c1", "source": "2.1", "text": "?", "verdict": verdict, "condition": null, "because": "",
            "findings": ["drift.largest"]
        }])
    };
    let written = |name: &str, claims: Value| {
        let mut all: Value = serde_json::from_str(&text).unwrap();
        all["studies"][0]["claims"] = claims;
        let file = folder.path().join(name);
        fs::write(&file, all.to_string()).unwrap();
        file.to_str().unwrap().to_owned()
    };
    let confirmed = written("confirmed.json", claim("confirmed"));
    for (claims, line, code) in [
        (claim("refuted"), "c1: confirmed, then refuted", 1),
        (claim("undecided"), "c1: confirmed, then undecided", 1),
        (json!([]), "c1: confirmed, then none", 1),
        (claim("confirmed"), "", 0),
        (
            json!([{
                "id": "c1", "source": "2.1", "text": "?", "verdict": "confirmed", "condition": "never", "because": "",
                "findings": ["drift.largest"]
            }]),
            "c1: confirmed, on other conditions or findings",
            1,
        ),
    ] {
        let other = written("other.json", claims);
        let said = compared(&[&confirmed, &other], code);
        assert!(said.contains(line), "{said}");
        assert_eq!(said.contains("a claim has another verdict"), code == 1, "{said}");
        // The other way round something became certain or was already.
        let code = if line.ends_with("refuted") || line.ends_with("findings") { 1 } else { 0 };
        compared(&[&other, &confirmed], code);
    }
}

#[test]
fn files_without_results_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let first = results(folder.path(), "first", [1.0, 1e9, 0.5], "agrees");
    let file = folder.path().join("other.json");
    for (text, message) in [
        ("{", "no JSON"),
        ("{}", "it has no schema; expected `libration.results/1`"),
        ("{\"schema\": \"libration.bodies/1\"}", "its schema is `libration.bodies/1`"),
        ("{\"schema\": \"libration.results/1\"}", "missing field `studies`"),
    ] {
        fs::write(&file, text).unwrap();
        let said = compared(&[first.to_str().unwrap(), file.to_str().unwrap()], 2);
        assert!(said.contains(message) && said.contains("other.json"), "{said}");
    }
    assert!(compared(&[first.to_str().unwrap(), "missing"], 2).contains("cannot read `missing`"));
    let path = first.to_str().unwrap();
    assert!(compared(&[path, path, "--noise", "2"], 2).contains("expected a number from 0 to 1"));
}
