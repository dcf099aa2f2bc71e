//! Unsafe code needs a safety comment.

use super::code::has_word;
use super::finding::Finding;
use super::source::Source;

const KEYWORD: &str = "unsafe";
const REASONS: [&str; 2] = ["SAFETY:", "# Safety"];

/// Unsafe blocks, functions and implementations without their reason above.
pub(super) fn check(source: &Source) -> Vec<Finding> {
    let code: Vec<&str> = source.code.lines().collect();
    let text: Vec<&str> = source.text.lines().collect();
    let unexplained = |&at: &usize| has_word(code[at], KEYWORD) && !has_reason(&code, &text, at);
    let advice = "say above it in a comment `SAFETY: …` why this is sound";
    (0..code.len())
        .filter(unexplained)
        .map(|at| Finding::new(&source.path, at + 1, advice))
        .collect()
}

/// Whether a reason stands at line `at`, or above it in the same statement or its comments.
fn has_reason(code: &[&str], text: &[&str], at: usize) -> bool {
    let begun = code[..at].iter().rposition(|line| line.trim_end().ends_with([';', '{', '}']));
    let start = begun.map_or(0, |end| end + 1);
    text[start..=at].iter().any(|line| REASONS.iter().any(|reason| line.contains(reason)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines found in a text where `U` stands for the keyword.
    fn lines(text: &str) -> Vec<usize> {
        let source = Source::new("a.rs", &text.replace('U', KEYWORD));
        check(&source).iter().map(|finding| finding.place().1).collect()
    }

    #[test]
    fn a_block_without_a_reason_is_found() {
        assert_eq!(lines("let a = 1;\nU { f() }\n"), [2]);
        assert_eq!(lines("// SAFETY: of the first.\nU { f() };\nU { g() };\n"), [3]);
        assert_eq!(lines("/// Fast.\npub U fn f() {}\n"), [2]);
    }

    #[test]
    fn a_reason_above_counts() {
        assert!(lines("// SAFETY: `f` only\n// adds.\nU { f() }\n").is_empty());
        assert!(lines("// SAFETY: adds.\nlet x =\n    U { f() };\n").is_empty());
        assert!(lines("/// # Safety\n/// Add only.\n#[inline]\nU fn f() {}\n").is_empty());
    }

    #[test]
    fn lint_names_and_comments_are_not_code() {
        assert!(lines("#![deny(U_code)]\n// U { }\nlet s = \"U\";\n").is_empty());
    }
}
