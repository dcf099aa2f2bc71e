//! `cargo xtask dependencies`: the crates that the engine may depend on.

use crate::{Outcome, command};

/// The engine, and what it depends on directly.
const ALLOWED: [&str; 17] = [
    "libration",
    "libration-analysis",
    "libration-batch",
    "libration-core",
    "bnum",
    "bytemuck",
    "half",
    "libm",
    "memmap2",
    "ndarray",
    "num-bigint",
    "num-complex",
    "num-integer",
    "pulp",
    "rayon",
    "sysinfo",
    "thiserror",
];

/// Never in its tree, not even through others.
const FORBIDDEN: [&str; 1] = ["serde"];

/// Fails if the engine depends on a crate that is not listed.
pub(crate) fn run() -> Outcome {
    let tree = |options: &str| {
        let options = format!("tree --package libration -e normal --prefix none {options}");
        command::output(&mut command::cargo(&options))
    };
    let direct = tree("--depth 2 --no-dedupe --target all")?;
    let mut found: Vec<&str> = names(&direct).filter(|name| !ALLOWED.contains(name)).collect();
    let whole = tree("")?;
    found.extend(names(&whole).filter(|name| FORBIDDEN.contains(name)));
    match found.as_slice() {
        [] => Ok(()),
        found => Err(format!(
            "the engine depends on {}. Numbers and physics know no formats, no settings and no studies: move the code \
             to the crate above that needs it, switch the feature off that brings the dependency in \
             (`cargo tree -p libration -i {}` shows the way), or add a crate for computing to `ALLOWED` in \
             xtask/src/dependencies.rs and say why in the commit",
            found.join(", "),
            found[0],
        )),
    }
}

/// The names in the lines `name version …` of a dependency tree.
fn names(tree: &str) -> impl Iterator<Item = &str> {
    tree.lines().filter_map(|line| line.split(' ').next()).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::{ALLOWED, names};

    #[test]
    fn a_tree_names_its_crates_and_neither_formats_nor_settings_are_allowed() {
        let tree =
            "libration v0.1.0 (…)\nlibration-data v0.1.0 (…)\nhalf v2.7.1\nserde_json v1.0.0 (*)\n";
        let found: Vec<&str> = names(tree).filter(|name| !ALLOWED.contains(name)).collect();
        assert_eq!(found, ["libration-data", "serde_json"]);
    }
}
