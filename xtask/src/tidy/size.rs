//! A crate stays small enough to compile in one step and to be known by one person.

use std::collections::BTreeMap;

use super::finding::Finding;
use super::source::Source;

const LARGEST: usize = 15_000;

/// Crates with too many lines of Rust, tests in other folders aside.
pub(super) fn check(sources: &[Source]) -> Vec<Finding> {
    let mut lines: BTreeMap<&str, usize> = BTreeMap::new();
    for source in sources {
        if let Some(folder) = source.crate_folder() {
            *lines.entry(folder).or_default() += source.text.lines().count();
        }
    }
    let large = lines.into_iter().filter(|(_, lines)| *lines > LARGEST);
    large
        .map(|(folder, lines)| {
            let manifest = folder.replace("src/", "Cargo.toml");
            let advice = format!(
                "{lines} lines of Rust, of at most {LARGEST}: move one subject into a crate of its \
                 own, and say in xtask/src/tidy/layers.rs which crates it may depend on"
            );
            Finding::new(&manifest, 1, advice)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(files: &[(&str, usize)]) -> Vec<String> {
        let source = |(path, lines): &(&str, usize)| Source::new(path, &"x\n".repeat(*lines));
        let sources: Vec<Source> = files.iter().map(source).collect();
        check(&sources).iter().map(|finding| finding.place().0.to_owned()).collect()
    }

    #[test]
    fn the_lines_of_all_files_count() {
        let [lib, other] = ["crates/a/src/lib.rs", "crates/a/src/b/c.rs"];
        assert_eq!(findings(&[(lib, LARGEST), (other, 1)]), ["crates/a/Cargo.toml"]);
        assert!(findings(&[(lib, LARGEST - 1), (other, 1)]).is_empty());
    }

    #[test]
    fn other_crates_tests_and_data_do_not_count() {
        let lib = ("crates/a/src/lib.rs", LARGEST);
        for path in ["crates/b/src/lib.rs", "crates/a/tests/src/b.rs", "crates/a/src/b.json"] {
            assert!(findings(&[lib, (path, LARGEST)]).is_empty(), "{path}");
        }
    }
}
