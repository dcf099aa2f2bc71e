//! The crates stand on floors, and each depends on crates of lower floors only.

use super::finding::Finding;
use super::source::Source;

/// The crates of each floor, the lowest first.
const FLOORS: [&[&str]; 13] = [
    &["libration-core"],
    &["libration-equations", "libration-linear"],
    &["libration-analysis", "libration-batch"],
    &["libration-bodies", "libration-linear-loops", "libration-live", "libration-replay"],
    &["libration"],
    &["libration-data", REPORT, "libration-work"],
    &["libration-logs", "libration-settings"],
    &["libration-analyze", "libration-energy", "libration-identify", "libration-probe"],
    &["libration-advise", "libration-env"],
    &["libration-study"],
    &["libration-study-batch", "libration-study-loops", "libration-study-motion"],
    &["libration-lab"],
    &["libration-cli", "libration-py"],
];

/// The floor of the engine's front; the rest of the engine is below.
const FRONT: usize = 4;

/// Records, findings, figures and pages.
const REPORT: &str = "libration-report";

/// Builds and checks the others, so it must compile where they do not.
const ALONE: &str = "xtask";

/// Crates that are on no floor, and dependencies on crates that are not below.
pub(super) fn check(sources: &[Source]) -> Vec<Finding> {
    let manifests: Vec<(&Source, &str)> = sources
        .iter()
        .filter(|source| is_member(&source.path))
        .filter_map(|source| Some((source, package(&source.text)?)))
        .collect();
    let in_workspace = |name: &str| {
        name == ALONE || floor(name).is_some() || manifests.iter().any(|(_, other)| *other == name)
    };
    let mut findings = Vec::new();
    for (source, name) in &manifests {
        if *name != ALONE && floor(name).is_none() {
            let advice = format!(
                "`{name}` is on no floor: say in the table FLOORS of xtask/src/tidy/layers.rs \
                 which crates it may depend on"
            );
            findings.push(Finding::new(&source.path, 1, advice));
            continue;
        }
        for (line, other) in dependencies(&source.text) {
            if let Some(reason) = objection(name, other).filter(|_| in_workspace(other)) {
                let advice = format!("`{name}` depends on `{other}`: {reason}");
                findings.push(Finding::new(&source.path, line, advice));
            }
        }
    }
    findings
}

/// Why the crate `name` may not depend on `other`.
fn objection(name: &str, other: &str) -> Option<&'static str> {
    let own = floor(name);
    if name == ALONE || other == ALONE {
        return Some("xtask must compile alone, so remove the dependency");
    }
    let Some(below) = floor(other) else {
        return Some("add that crate to the table FLOORS in xtask/src/tidy/layers.rs first");
    };
    if own.is_none_or(|own| own <= below) {
        return Some(
            "a crate may depend on lower floors only (the table FLOORS in \
             xtask/src/tidy/layers.rs): move what both need to a crate below both",
        );
    }
    if name == REPORT && below <= FRONT {
        return Some("a report knows no physics: give its functions numbers and text");
    }
    let is_inner = below < FRONT && own.is_some_and(|own| own > FRONT);
    is_inner.then_some("a crate outside the engine depends on the front `libration` instead")
}

fn floor(name: &str) -> Option<usize> {
    FLOORS.iter().position(|crates| crates.contains(&name))
}

/// Whether the file is the manifest of a crate of the workspace.
fn is_member(path: &str) -> bool {
    let folder = path.strip_suffix("/Cargo.toml").map(|path| path.split('/').collect::<Vec<_>>());
    matches!(folder.as_deref(), Some(["crates", _] | ["xtask"]))
}

fn package(manifest: &str) -> Option<&str> {
    let (_, table) = manifest.split_once("[package]")?;
    table.lines().find_map(|line| quoted_value(line.strip_prefix("name")?))
}

/// The text in quotes after an equals sign.
fn quoted_value(assigned: &str) -> Option<&str> {
    assigned.trim_start().strip_prefix('=')?.trim_start().strip_prefix('"')?.split('"').next()
}

/// Line and package of each dependency of a manifest, those of tests aside.
fn dependencies(manifest: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut is_table = false;
    for (number, line) in (1..).zip(manifest.lines()) {
        if let Some(header) = line.strip_prefix('[') {
            let header = header.trim_end().trim_end_matches(']');
            is_table = is_dependencies(header);
            // A dependency may have a table of its own.
            let own = header.rsplit_once('.').filter(|(table, _)| is_dependencies(table));
            found.extend(own.map(|(_, name)| (number, name)));
        } else if is_table {
            let key = line.split(['.', '=', ' ']).next().unwrap_or_default().trim_matches('"');
            let renamed = line.split_once("package").and_then(|(_, value)| quoted_value(value));
            found.push((number, renamed.unwrap_or(key)));
        }
    }
    found
}

/// Whether a table lists dependencies that the crate is built with, perhaps on some platforms only.
fn is_dependencies(header: &str) -> bool {
    let list = header.rsplit_once('.').map_or(header, |(_, list)| list);
    let is_for_platform = header == list || header.starts_with("target.");
    is_for_platform && ["dependencies", "build-dependencies"].contains(&list)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of the findings in the manifest of `name`, in whose folder it is.
    fn lines(name: &str, tables: &str) -> Vec<usize> {
        let folder = if name == ALONE { String::new() } else { "crates/".to_owned() };
        let text = format!("[package]\nname = \"{name}\"\n{tables}");
        let sources = [
            Source::new(&format!("{folder}{name}/Cargo.toml"), &text),
            Source::new("crates/new/Cargo.toml", "[package]\nname = \"new\"\n"),
        ];
        let own = |finding: &&Finding| finding.place().0 == sources[0].path;
        check(&sources).iter().filter(own).map(|finding| finding.place().1).collect()
    }

    /// Whether `name` may depend on `other`.
    fn may(name: &str, other: &str) -> bool {
        lines(name, &format!("[dependencies]\n{other}.workspace = true\n")).is_empty()
    }

    #[test]
    fn a_crate_that_is_on_no_floor_is_found() {
        assert_eq!(lines("libration-cloud", ""), [1]);
        assert!(!may("libration-cli", "new"));
    }

    #[test]
    fn dependencies_lead_down() {
        assert!(may("libration-study-motion", "libration-advise"));
        assert!(may("libration-lab", "libration-data"));
        assert!(!may("libration-data", "libration-report"));
        assert!(!may("libration-study-motion", "libration-study-loops"));
        assert!(!may("libration-core", "libration"));
        assert!(!may("libration-data", "libration-settings"));
    }

    #[test]
    fn users_know_the_front_of_the_engine_only() {
        assert!(may("libration", "libration-core") && may("libration-batch", "libration-core"));
        assert!(may("libration-data", "libration") && !may("libration-data", "libration-core"));
        assert!(!may("libration-cli", "libration-batch"));
    }

    #[test]
    fn a_report_knows_no_physics_and_xtask_no_crate() {
        assert!(!may(REPORT, "libration") && !may(REPORT, "libration-analysis"));
        assert!(!may(ALONE, "libration") && !may("libration-lab", ALONE));
        assert!(may(REPORT, "serde") && may(ALONE, "serde"));
    }

    #[test]
    fn every_way_to_write_a_dependency_counts_but_tests_are_free() {
        for table in [
            "[target.\"cfg(unix)\".dependencies]\nlibration = { workspace = true }",
            "[build-dependencies]\n\"libration\" = \"1\"",
            "[dependencies]\nit = { path = \"x\", package = \"libration\" }",
        ] {
            assert_eq!(lines("libration-core", table), [4], "{table}");
        }
        assert_eq!(lines("libration-core", "[dependencies.libration]\nworkspace = true"), [3]);
        for table in ["[dev-dependencies]", "[target.'cfg(unix)'.dev-dependencies]", "[features]"] {
            assert!(lines("libration-core", &format!("{table}\nlibration = []")).is_empty());
        }
    }
}
