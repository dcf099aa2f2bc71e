//! No invisible differences.

use super::finding::Finding;
use super::source::Source;

/// Blanks at line ends, and files that do not end with a line end.
pub(super) fn check(source: &Source) -> Vec<Finding> {
    let mut findings: Vec<Finding> = source
        .text
        .split('\n')
        .zip(1..)
        .filter(|(line, _)| line.ends_with(char::is_whitespace))
        .map(|(_, number)| {
            Finding::new(&source.path, number, "remove the blanks at the line's end")
        })
        .collect();
    if !source.text.is_empty() && !source.text.ends_with('\n') {
        let last = source.text.lines().count();
        findings.push(Finding::new(&source.path, last, "end the file with a newline"));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<usize> {
        check(&Source::new("a.md", text)).iter().map(|finding| finding.place().1).collect()
    }

    #[test]
    fn blanks_at_line_ends_are_found() {
        assert_eq!(lines("a\nb \nc\t\nd\r\n"), [2, 3, 4]);
        assert!(lines("a\n\n  b\n").is_empty());
    }

    #[test]
    fn a_missing_last_newline_is_found() {
        assert_eq!(lines("a\nb"), [2]);
        assert!(lines("").is_empty());
    }
}
