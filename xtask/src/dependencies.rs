//! `cargo xtask dependencies`: what the engine must never depend on.

use crate::{Outcome, command};

const FORBIDDEN: [&str; 4] = ["serde", "libration-data", "libration-lab", "libration-cli"];

/// Fails if the engine's dependency tree holds a forbidden crate.
pub(crate) fn run() -> Outcome {
    let tree =
        command::output(&mut command::cargo("tree --package libration -e normal --prefix none"))?;
    match forbidden_in(&tree).as_slice() {
        [] => Ok(()),
        found => Err(format!(
            "crates/libration depends on {}. Numbers and physics know no formats and no studies: \
             serialise in crates/libration-data, measure in crates/libration-lab, or switch the feature off that \
             brings it in (`cargo tree -p libration -i {}` shows the way)",
            found.join(", "),
            found[0],
        )),
    }
}

/// The forbidden crates among the lines `name version …` of a dependency tree.
fn forbidden_in(tree: &str) -> Vec<&'static str> {
    let names: Vec<&str> = tree.lines().filter_map(|line| line.split(' ').next()).collect();
    FORBIDDEN.into_iter().filter(|name| names.contains(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::forbidden_in;

    #[test]
    fn a_tree_with_serde_or_the_laboratory_is_refused() {
        assert_eq!(forbidden_in("libration v0.1.0 (…)\nserde v1.0.0\n"), ["serde"]);
        let lab = "libration v0.1.0 (…)\nlibration-lab v0.1.0 (…)\n";
        assert_eq!(forbidden_in(lab), ["libration-lab"]);
    }

    #[test]
    fn a_tree_of_numbers_passes() {
        assert!(forbidden_in("libration v0.1.0 (…)\nhalf v2.7.1\nthiserror v2.0.0\n").is_empty());
    }
}
