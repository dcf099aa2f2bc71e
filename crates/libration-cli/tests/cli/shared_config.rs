//! One file for `lab`, `advise` and `rollout`, through the binary.

use std::fs;
use std::path::PathBuf;

use predicates::prelude::*;
use predicates::str::{contains, is_empty};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::advise::libration;
use super::linear::written;

/// The file of the guide.
const EXAMPLE: &str = include_str!("../../../../examples/shared.toml");

/// A file in a folder, and the folder for output.
fn file(text: &str) -> (TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = written(&folder, "shared.toml", text);
    let out = folder.path().join("out");
    (folder, file, out)
}

fn words<'a>(command: &'a str, file: &'a str, out: &'a str) -> Vec<&'a str> {
    let mut words: Vec<&str> = command.split(' ').collect();
    words.extend(["--config", file]);
    if !command.contains("advise") {
        words.extend(["--out", out]);
    }
    words
}

#[test]
fn one_file_serves_the_three_commands() {
    let (_folder, file, out) = file(EXAMPLE);
    let file = file.to_str().unwrap();
    let lab = out.with_extension("lab");
    libration(&words("--quiet lab", file, lab.to_str().unwrap())).success();
    let results: Value =
        serde_json::from_slice(&fs::read(lab.join("results.json")).unwrap()).unwrap();
    assert_eq!(results["config"]["system"], json!({ "oscillator": { "k": 20.0, "m": 2.0 } }));
    assert_eq!(results["config"]["start"], json!({ "q": 0.5, "v": 0.0 }));
    assert_eq!(results["config"]["spectrum"]["dt"], 0.005);

    let advice = super::advise::json(&words("advise", file, ""));
    assert_eq!(advice["parameters"], json!({ "m": 2.0, "k": 20.0 }));

    libration(&words("--quiet rollout", file, out.to_str().unwrap())).success();
    let manifest = fs::read_to_string(out.join("manifest.jsonl")).unwrap();
    let head: Value = serde_json::from_str(manifest.lines().next().unwrap()).unwrap();
    assert_eq!(head["data"]["system"], json!({ "oscillator": { "k": 20.0, "m": 2.0 } }));
    assert_eq!(head["data"]["start"], json!({ "q": [0.5, 0.5], "v": [0.0, 0.0] }));
}

#[test]
fn a_note_names_the_tables_that_a_command_ignores() {
    let (_folder, file, out) = file(EXAMPLE);
    let (file, out) = (file.to_str().unwrap(), out.to_str().unwrap());
    let note = "note: `advise` ignores `effort`, `spectrum`, `studies` of `lab`; `chunk`, ";
    libration(&words("advise", file, out)).success().stderr(contains(note));
    libration(&words("--quiet advise", file, out)).success().stderr(is_empty());
    let note = contains(
        "note: `rollout` ignores `controller`, `loop`, `request`, `tolerance` of `advise`; ",
    );
    libration(&words("rollout", file, out)).success().stderr(note);
}

#[test]
fn a_misspelt_table_is_an_error_of_each_command() {
    for command in ["lab", "advise", "rollout"] {
        for (right, wrong) in [("[controller.pd]", "controler"), ("[chunk]", "chunks")] {
            let name = right.trim_matches(['[', ']']).split('.').next().unwrap();
            let text = EXAMPLE.replace(right, &right.replace(name, wrong));
            assert_ne!(text, EXAMPLE);
            let (_folder, file, out) = file(&text);
            let (file, out) = (file.to_str().unwrap(), out.to_str().unwrap());
            let unknown = contains(format!("unknown key `{wrong}`"));
            let error = unknown.and(contains(format!("did you mean `{name}`")));
            libration(&words(command, file, out)).code(2).stderr(error);
        }
    }
}
