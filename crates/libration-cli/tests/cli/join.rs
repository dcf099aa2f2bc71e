//! The command `join` as a user meets it.

use predicates::prelude::PredicateBooleanExt;
use predicates::str::{contains, is_empty};

use crate::rollout::{SETTINGS, contents, libration, settings, write};

#[test]
fn shards_are_joined_to_the_bytes_of_one_run_and_what_is_no_data_set_together_exits_with_2() {
    let dir = settings(SETTINGS);
    let run = |words: &str| libration(words).current_dir(dir.path()).assert();
    write(&dir, "whole", "").success();
    for i in 1..=3 {
        write(&dir, &format!("part-{i}"), &format!("--shard {i}/3")).success();
    }
    let whole = contents(&dir.path().join("whole"));
    for (out, flags) in [("copied", ""), ("linked", "--link")] {
        let joined = run(&format!("join part-2 part-3 part-1 --out {out} {flags}")).success();
        joined.stdout(contains("157500 transitions in 30 chunks").and(contains(out)));
        assert!(contents(&dir.path().join(out)) == whole, "{out}");
    }
    run("verify linked --replay").success();
    run("join part-2 part-3 part-1 --out copied").code(2).stderr(contains("--resume"));
    run("--quiet join part-2 part-3 part-1 --out copied --resume").success().stdout(is_empty());
    run("join part-1 part-3 --out other").code(2).stderr(contains("is a shard missing?"));
    run("join part-1 part-1 part-2 part-3 --out other")
        .code(2)
        .stderr(contains("part-1 and in part-1"));
    run("join part-1 nowhere --out other").code(2).stderr(contains("nowhere holds no data set"));
    run("join --out other").code(2).stderr(contains("<PART>"));
    run("join part-1").code(2).stderr(contains("--out"));
    assert!(!dir.path().join("other").exists());
}
