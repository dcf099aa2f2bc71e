//! `verify` of a report, and `lab --only`.

use std::fs;

use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;

use super::advise::libration;

#[test]
fn verify_recomputes_a_report_and_names_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let config = folder.path().join("short.toml");
    fs::write(&config, "[drift]\nsteps = 20_000\n").unwrap();
    let config = config.to_str().unwrap();
    let folder = out.to_str().unwrap();
    let lab = ["lab", "spectrum", "drift", "--effort", "quick", "--config", config];
    libration(&[&lab[..], &["--out", folder]].concat()).success();
    libration(&["verify", folder]).success().stdout(
        contains("The report is verified: ").and(contains("spectrum: ")).and(contains("same bits")),
    );
    let file = out.join("results.json");
    let mut results: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let measured = &mut results["studies"][1]["findings"][0]["measured"];
    // One unit in the last place.
    let other = f64::from_bits(measured.as_f64().unwrap().to_bits() + 1);
    *measured = other.into();
    let id = results["studies"][1]["findings"][0]["id"].as_str().unwrap().to_owned();
    fs::write(&file, results.to_string()).unwrap();
    let series = results["studies"][1]["data"][0]["file"].as_str().unwrap().to_owned();
    let mut bytes = fs::read(out.join(&series)).unwrap();
    bytes[40] ^= 1;
    fs::write(out.join(&series), bytes).unwrap();
    let figure = results["studies"][1]["figures"][0]["file"].as_str().unwrap().to_owned();
    let drawn = fs::read_to_string(out.join(&figure)).unwrap();
    fs::write(out.join(&figure), drawn.replacen("stroke", "stroke ", 1)).unwrap();
    fs::write(out.join("data/mine.csv"), "1").unwrap();
    libration(&["verify", folder])
        .code(1)
        .stdout(contains("not verified: fault: 3 differences"))
        .stdout(contains("`data/mine.csv`, which the results do"))
        .stderr(contains(format!("the file `{figure}` differs")))
        .stderr(contains(format!("the finding `{id}` differs: measured {other:?}, recomputed")))
        .stderr(contains(format!("the file `{series}` differs")));
    libration(&["verify", folder, "--repair"]).code(2);
    fs::write(&file, "{}").unwrap();
    libration(&["verify", folder]).code(2).stderr(contains("results.json`: missing field"));
}

#[test]
fn only_recomputes_one_finding_with_all_digits_and_writes_no_report() {
    let folder = tempfile::tempdir().unwrap();
    let lab = |id: &str| {
        let mut command = assert_cmd::Command::cargo_bin("libration").unwrap();
        command.current_dir(&folder).args(["lab", "--effort", "quick", "--only", id]).assert()
    };
    lab("stability.velocity-verlet.window-1-to")
        .success()
        .stdout(contains("predicted  2.0\n").and(contains("verdict    agrees\n")));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
    lab("stability.velocity-verlet.window-1")
        .code(2)
        .stderr(contains("did you mean `stability.velocity-verlet.window-1-to`?"));
    lab("stabilty.x").code(2).stderr(contains("did you mean `stability`?"));
}

/// The results of a short report, and its folder.
fn report(folder: &std::path::Path, studies: &[&str]) -> (std::path::PathBuf, Value) {
    let out = folder.join("out");
    let options = ["--effort", "quick"];
    let words = [&["lab"], studies, &options, &["--out", out.to_str().unwrap()]].concat();
    libration(&words).success();
    let file = out.join("results.json");
    let results = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    (file, results)
}

#[test]
fn a_report_with_a_part_that_cannot_be_recomputed_is_not_verified() {
    let folder = tempfile::tempdir().unwrap();
    let (file, results) = report(folder.path(), &["spectrum"]);
    let out = file.parent().unwrap().to_str().unwrap().to_owned();
    let forge = |study: &mut Value| study["findings"][0]["measured"] = 1e9.into();
    let verify = |change: &dyn Fn(&mut Vec<Value>), said: &str| {
        let mut results = results.clone();
        change(results["studies"].as_array_mut().unwrap());
        fs::write(&file, results.to_string()).unwrap();
        libration(&["verify", &out, "--quiet"])
            .code(1)
            .stdout(contains("is not verified: "))
            .stdout(contains(said).and(contains("verified: no fault").not()));
    };
    let renamed = |name: &'static str| {
        move |studies: &mut Vec<Value>| {
            forge(&mut studies[0]);
            studies[0]["name"] = name.into();
        }
    };
    verify(&renamed("spectra"), "unknown: not recomputed: `spectra` is no study of this version");
    verify(&renamed("throughput"), "`throughput` measures the machine");
    verify(&renamed("a\u{1b}[2Jb\nerror: c"), "`a\\u001b[2Jb\\u000aerror: c` is no study");
    let twice = |studies: &mut Vec<Value>| {
        studies.push(studies[0].clone());
        forge(&mut studies[1]);
    };
    verify(&twice, "`spectrum` is in the report twice");
    verify(&|studies| studies.clear(), "unknown: the report has no study");
    let timed = |studies: &mut Vec<Value>| {
        let mut own = studies[0]["findings"][0].clone();
        own["id"] = "spectrum.forged.time".into();
        studies[0]["findings"].as_array_mut().unwrap().push(own);
    };
    verify(&timed, "fault: 1 difference");
    let copied = |studies: &mut Vec<Value>| {
        let own = studies[0]["findings"][0].clone();
        studies[0]["findings"].as_array_mut().unwrap().push(own);
    };
    verify(&copied, "fault: 1 difference");
    verify(&|studies| studies[0]["data"] = serde_json::json!([]), "fault: ");
    verify(&|studies| studies[0]["figures"] = serde_json::json!([]), "fault: ");
}
