//! Files stay short enough to read in one sitting.

use super::finding::Finding;
use super::source::Source;

const LONGEST_RUST: usize = 300;
const LONGEST_README: usize = 100;

/// An exception stands in the module's own documentation, among its first lines.
const EXCEPTION: &str = "//! long:";
const TOP: usize = 20;

/// Files that are too long, without a reason.
pub(super) fn check(source: &Source) -> Vec<Finding> {
    let lines = source.text.lines().count();
    let (longest, advice) = if source.path.ends_with(".rs") && !has_reason(source) {
        (LONGEST_RUST, "one noun per file: split it, or say why not with `//! long: reason` on top")
    } else if source.path == "README.md" {
        (
            LONGEST_README,
            "keep the claim and the two commands, move the rest to a document of its own",
        )
    } else {
        return Vec::new();
    };
    if lines <= longest {
        return Vec::new();
    }
    let advice = format!("{lines} lines, of at most {longest}: {advice}");
    vec![Finding::new(&source.path, longest + 1, advice)]
}

fn has_reason(source: &Source) -> bool {
    let mut top = source.text.lines().take(TOP);
    top.any(|line| line.strip_prefix(EXCEPTION).is_some_and(|reason| !reason.trim().is_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(path: &str, text: &str) -> usize {
        check(&Source::new(path, text)).len()
    }

    #[test]
    fn a_long_file_needs_a_reason() {
        let long = "x\n".repeat(301);
        assert_eq!(findings("src/a.rs", &long), 1);
        assert_eq!(findings("src/a.rs", &long[2..]), 0);
        assert_eq!(findings("src/a.rs", &format!("//! A table.\n//! long: one table\n{long}")), 0);
        assert_eq!(findings("src/a.rs", &format!("//! long: \n{long}")), 1);
        assert_eq!(findings("src/a.rs", &format!("{long}//! long: too late\n")), 1);
        assert_eq!(findings("notes.md", &long), 0);
    }

    #[test]
    fn a_long_readme_is_too_long() {
        assert_eq!(findings("README.md", &"x\n".repeat(101)), 1);
        assert_eq!(findings("README.md", &"x\n".repeat(100)), 0);
    }
}
