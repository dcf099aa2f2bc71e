//! Data sets whose manifest states other contents than their settings.

use std::fs;

use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;

use crate::rollout::{libration, settings, write};
use crate::verify::EPISODES;

#[test]
fn a_manifest_that_states_other_contents_than_the_settings_does_not_pass() {
    let dir = settings(EPISODES);
    write(&dir, "set", "--format npy").success();
    let manifest = dir.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    // Two chunks of 50 steps of 64 environments.
    for (good, edited, key) in [
        ("\"transitions\":3200", "\"transitions\":3199", "transitions"),
        ("\"transitions\":3200", "\"transitions\":\"3200\"", "transitions"),
        ("\"steps\":[50,100]", "\"steps\":[50,99]", "steps"),
        ("\"environments\":[0,64]", "\"environments\":[0,65]", "environments"),
        ("\"ends\":", "\"ends\":9", "ends"),
        ("\"seed\":0", "\"seed\":1", "seed"),
    ] {
        // In the last entry alone.
        let at = text.rfind(good).unwrap_or_else(|| panic!("{good}\n{text}"));
        let changed = format!("{}{edited}{}", &text[..at], &text[at + good.len()..]);
        fs::write(&manifest, changed).unwrap();
        let said = contains("set/manifest.jsonl states").and(contains(format!("as `{key}`")));
        libration("verify set").current_dir(dir.path()).assert().code(1).stderr(said);
        libration("verify set --replay").current_dir(dir.path()).assert().code(1);
    }
    fs::write(&manifest, &text).unwrap();
    libration("verify set").current_dir(dir.path()).assert().success();
}

#[test]
fn counts_and_settings_that_verify_does_not_recompute_are_named() {
    let dir = settings(EPISODES);
    write(&dir, "set", "--format npy").success();
    let manifest = dir.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let verify = |words: &str| libration(words).current_dir(dir.path()).assert();
    let count = text.rfind("\"ends\":").unwrap() + "\"ends\":".len();
    let other = format!(
        "{}1{}",
        &text[..count],
        &text[count..].trim_start_matches(|c: char| c.is_ascii_digit())
    );
    for changed in [other, text.replace("\"dt\":0.01", "\"dt\":0.02")] {
        assert_ne!(changed, text);
        fs::write(&manifest, changed).unwrap();
        let named = contains(
            "Not examined: whether the settings lead to these files, the counts `ends` of the manifest",
        );
        verify("verify set").success().stdout(named.and(contains("all with the checksums")));
        verify("verify set --replay").code(1).stdout("");
    }
    fs::write(&manifest, &text).unwrap();
    verify("verify set --replay").success().stdout(contains("Not examined").not());
    // Another version may compute other numbers.
    fs::write(&manifest, text.replace("\"version\":\"0", "\"version\":\"7")).unwrap();
    verify("verify set")
        .success()
        .stdout(contains("Not examined: all but checksums").and(contains("written by version")));
    for (good, edited, key) in [
        ("\"unit\":\"m\"", "\"unit\":\"mm\"", "observation"),
        ("\"symplectic-euler\"", "\"symplectic\"", "integrator"),
        ("\"groups\":[0,1]", "\"groups\":[0,3]", "groups"),
    ] {
        let changed = text.replace(good, edited);
        assert_ne!(changed, text, "{text}");
        fs::write(&manifest, changed).unwrap();
        let said = contains("set/manifest.jsonl has a first line that this version does not write")
            .and(contains(key));
        verify("verify set").code(1).stdout("").stderr(said);
    }
}
