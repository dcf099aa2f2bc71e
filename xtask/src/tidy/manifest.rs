//! Every crate of the workspace takes the workspace's lints.

use super::finding::Finding;
use super::source::Source;

/// Manifests of members that set lints of their own, or none.
pub(super) fn check(source: &Source) -> Vec<Finding> {
    if source.file_name() != "Cargo.toml" {
        return Vec::new();
    }
    let tables: Vec<&str> = source.text.lines().filter(|line| line.starts_with('[')).collect();
    // A manifest with `[workspace]` is the root, or stands outside, as a fuzz crate does.
    let is_member = tables.contains(&"[package]") && !tables.contains(&"[workspace]");
    if !is_member || inherits_lints(&source.text) {
        return Vec::new();
    }
    let advice = "the crate escapes the workspace's lints: add `[lints]` with `workspace = true`";
    vec![Finding::new(&source.path, 1, advice)]
}

fn inherits_lints(manifest: &str) -> bool {
    let mut table = "";
    manifest.lines().any(|line| {
        if line.starts_with('[') {
            table = line.trim_end();
        }
        table == "[lints]" && line.replace(' ', "") == "workspace=true"
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(text: &str) -> usize {
        check(&Source::new("crates/a/Cargo.toml", text)).len()
    }

    #[test]
    fn a_member_without_the_lints_is_found() {
        assert_eq!(findings("[package]\nname = \"a\"\n"), 1);
        assert_eq!(findings("[package]\n[lints.clippy]\nall = \"warn\"\n"), 1);
        assert_eq!(findings("[package]\n[lints]\n[dependencies]\nworkspace = true\n"), 1);
        assert_eq!(findings("[package]\n\n[lints]\nworkspace = true\n"), 0);
    }

    #[test]
    fn a_workspace_of_its_own_is_exempt() {
        assert_eq!(findings("[workspace]\nmembers = [\"a\"]\n"), 0);
        assert_eq!(findings("[package]\nname = \"fuzz\"\n[workspace]\n"), 0);
    }
}
