//! Nothing in the project may know the machine it was written on, or a package registry.

use super::finding::Finding;
use super::source::Source;

// Spelled in pieces, so that this file passes its own check.
const FOLDERS: [&str; 3] =
    [concat!("/", "work/"), concat!("/", "root/"), concat!("/", "tmp/", "wt")];
const SIBLING: &str = concat!("../", "shared");
const REGISTRIES: [&str; 3] = ["crates", "pypi", "npmjs"];
const ENDINGS: [&str; 3] = [".io", ".org", ".com"];

/// Paths of one machine and hosts of registries; lock files, which cargo writes, are exempt.
pub(super) fn check(source: &Source) -> Vec<Finding> {
    if source.file_name() == "Cargo.lock" {
        return Vec::new();
    }
    let mut findings = Vec::new();
    for (number, line) in source.lines() {
        if FOLDERS.iter().any(|folder| has_absolute(line, folder)) || line.contains(SIBLING) {
            let advice = "a clone has no such folder: use a path from the root of the workspace, \
                          or a temporary one";
            findings.push(Finding::new(&source.path, number, advice));
        }
        if has_registry(line) {
            let advice = "names a package registry, which a user may have replaced: name the \
                          package only";
            findings.push(Finding::new(&source.path, number, advice));
        }
    }
    findings
}

/// Whether `folder` stands in `line` as the beginning of a path.
fn has_absolute(line: &str, folder: &str) -> bool {
    let inside = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
    line.match_indices(folder).any(|(at, _)| !line[..at].ends_with(inside))
}

fn has_registry(line: &str) -> bool {
    REGISTRIES.iter().any(|name| {
        line.match_indices(name)
            .any(|(at, _)| ENDINGS.iter().any(|end| line[at + name.len()..].starts_with(end)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(path: &str, text: &str) -> usize {
        check(&Source::new(path, text)).len()
    }

    #[test]
    fn folders_of_a_machine_are_found() {
        for folder in FOLDERS {
            assert_eq!(findings("a.md", &format!("see {folder}notes")), 1);
            assert_eq!(findings("a.md", &format!("see src{folder}notes")), 0);
        }
        assert_eq!(findings("a.rs", &format!("include!(\"{SIBLING}/a\")")), 1);
    }

    #[test]
    fn registries_are_found_except_in_lock_files() {
        for (name, end) in REGISTRIES.iter().zip(ENDINGS) {
            let line = format!("https://{name}{end}/libration");
            assert_eq!(findings("README.md", &line), 1);
            assert_eq!(findings("fuzz/Cargo.lock", &line), 0);
        }
        assert_eq!(findings("README.md", "all crates. iodine"), 0);
    }
}
