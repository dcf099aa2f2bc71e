//! `libration advise` for loops that miss deadlines, through the binary.

use predicates::prelude::*;

use super::advise::{json, libration};
use super::linear::example;
use super::short_answers::write_pendulum;

#[test]
fn the_example_of_a_pendulum_says_how_many_deadlines_it_may_miss() {
    let path = example("furuta_pendulum.toml");
    let advice = json(&["advise", "--config", &path]);
    let worst = &advice["deadline_misses"]["worst_case"];
    assert_eq!(worst["stated"]["verdict"], "stable", "{worst}");
    let tried = worst["tried"].as_array().unwrap();
    assert_eq!(tried.last().unwrap()["verdict"], "unstable");
    let bounds = |row: &serde_json::Value| ["lower", "upper"].map(|key| row[key].as_f64().unwrap());
    assert!(tried.iter().map(bounds).all(|[lower, upper]| lower <= upper));
    let folder = tempfile::tempdir().unwrap();
    let path = write_pendulum(folder.path());
    libration(&["advise", "--config", path.to_str().unwrap(), "--verbose"]).success().stdout(
        predicate::str::contains("at most 2 of 5").and(predicate::str::contains("worst sequence")),
    );
}
