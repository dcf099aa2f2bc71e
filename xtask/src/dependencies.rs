//! `cargo xtask dependencies`: the crates that the engine may depend on, those of the wheel that the tests compile anyway, and licenses.

use crate::{Outcome, command, licenses};

/// The engine, and what it depends on directly.
const ALLOWED: [&str; 24] = [
    "libration",
    "libration-analysis",
    "libration-batch",
    "libration-bodies",
    "libration-core",
    "libration-equations",
    "libration-linear",
    "libration-linear-loops",
    "libration-live",
    "libration-replay",
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
    "winnow",
];

/// Never in its tree, not even through others.
const FORBIDDEN: [&str; 2] = ["serde", "serde_core"];

/// Fails if the engine depends on a crate that is not listed, or the tests of the wheel would compile a crate once more.
pub(crate) fn run() -> Outcome {
    engine()?;
    wheel()?;
    licenses::check()
}

/// The wheel is made of what the tests of the workspace have compiled, if all its dependencies have the same features.
fn wheel() -> Outcome {
    let tree = |options: &str| {
        let mut command = command::cargo(&format!("tree --prefix none {options}"));
        command::output(command.args(["--format", "{p} {f}"]))
    };
    let tests = tree("--workspace -e normal,build,dev")?;
    let wheel = tree("--package libration-py --features as-tested -e normal,build")?;
    match only_in(&wheel, &tests).as_slice() {
        [] => Ok(()),
        apart => Err(format!(
            "the tests of the Python package would compile dependencies anew, with other features than the tests of the \
             workspace: {}. Give the feature `as-tested` of crates/libration-py what is missing, or take from it what no \
             test needs any more",
            apart.join(", "),
        )),
    }
}

/// The crates of one tree that another does not have with the same features, but for the package itself.
fn only_in<'a>(tree: &'a str, other: &str) -> Vec<&'a str> {
    let bare = |line: &'_ str| line.trim_end_matches(" (*)").trim_end().to_owned();
    let known: Vec<String> = other.lines().map(bare).collect();
    let apart = |line: &&str| !line.starts_with("libration-py ") && !known.contains(&bare(line));
    tree.lines().filter(apart).collect()
}

/// Fails if the engine depends on a crate that is not listed.
fn engine() -> Outcome {
    let tree = |options: &str| {
        let options = format!(
            "tree --package libration -e normal --prefix none --all-features --target all {options}"
        );
        command::output(&mut command::cargo(&options))
    };
    let direct = tree("--depth 2 --no-dedupe")?;
    let mut found: Vec<&str> = names(&direct).filter(|name| !ALLOWED.contains(name)).collect();
    let whole = tree("")?;
    found.extend(names(&whole).filter(|name| FORBIDDEN.contains(name)));
    found.sort_unstable();
    found.dedup();
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
    use super::{ALLOWED, names, only_in};

    #[test]
    fn a_tree_names_its_crates_and_neither_formats_nor_settings_are_allowed() {
        let tree =
            "libration v0.1.0 (…)\nlibration-data v0.1.0 (…)\nhalf v2.7.1\nserde_json v1.0.0 (*)\n";
        let found: Vec<&str> = names(tree).filter(|name| !ALLOWED.contains(name)).collect();
        assert_eq!(found, ["libration-data", "serde_json"]);
    }

    #[test]
    fn a_dependency_with_other_features_is_told_but_the_wheel_itself_is_not() {
        let tests = "libration-py v0.1.0 (…) \nhashbrown v0.17.1 \nlibc v0.2.191 std (*)\n";
        let wheel =
            "libration-py v0.1.0 (…) as-tested\nhashbrown v0.17.1 default\nlibc v0.2.191 std\n";
        assert_eq!(only_in(wheel, tests), ["hashbrown v0.17.1 default"]);
    }
}
