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
