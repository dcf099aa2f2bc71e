//! `cargo xtask dependencies`: the crates that the engine may depend on, the features that all builds share, and licenses.

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

/// Fails if the engine depends on a crate that is not listed, or one of the builds would compile a crate of another once more.
pub(crate) fn run() -> Outcome {
    engine()?;
    builds()?;
    licenses::check()
}

/// The program, the wheel and the tests of the workspace are made of one set of libraries, if their dependencies have the same features.
fn builds() -> Outcome {
    let tree = |options: &str| {
        let mut command = command::cargo(&format!("tree --prefix none {options}"));
        command::output(command.args(["--format", "{p} {f}"]))
    };
    let tests = tree("--workspace -e normal,build,dev")?;
    let wheel = tree("--package libration-py -e normal,build")?;
    let program = tree("--package libration-cli -e normal,build")?;
    let mut apart = only_in(&wheel, &tests);
    apart.extend(only_in(&program, &tests));
    apart.extend(differing(&wheel, &program));
    apart.sort_unstable();
    apart.dedup();
    match apart.as_slice() {
        [] => Ok(()),
        apart => Err(format!(
            "the program, the Python package and the tests of the workspace would each compile dependencies anew, which have other \
             features in one than in another: {}. Give crates/libration-cli or crates/libration-py the features that it lacks, or \
             take from it what no other needs any more",
            apart.join(", "),
        )),
    }
}

/// The crates of one tree that another has in the same version with other features.
fn differing<'a>(tree: &'a str, other: &str) -> Vec<&'a str> {
    let version = |line: &'_ str| line.split(' ').take(2).collect::<Vec<_>>().join(" ");
    let known: Vec<String> = other.lines().map(version).collect();
    only_in(tree, other).into_iter().filter(|line| known.contains(&version(line))).collect()
}

/// The crates of one tree that another does not have with the same features, but for the package itself.
fn only_in<'a>(tree: &'a str, other: &str) -> Vec<&'a str> {
    let bare = |line: &'_ str| line.trim_end_matches(" (*)").trim_end().to_owned();
    let known: Vec<String> = other.lines().map(bare).collect();
    let apart = |line: &&str| !line.starts_with("libration-py ") && !known.contains(&bare(line));
    tree.lines().filter(apart).map(|line| line.trim_end_matches(" (*)")).collect()
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
    use super::{ALLOWED, differing, names, only_in};

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
        let wheel = "libration-py v0.1.0 (…)\nhashbrown v0.17.1 default\nlibc v0.2.191 std\nnumpy v0.30.0\n";
        assert_eq!(only_in(wheel, tests), ["hashbrown v0.17.1 default", "numpy v0.30.0"]);
        assert_eq!(differing(wheel, tests), ["hashbrown v0.17.1 default"]);
    }
}
