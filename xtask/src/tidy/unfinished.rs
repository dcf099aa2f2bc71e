//! Nothing is left for later without a trace outside the code.

use super::code::has_word;
use super::finding::Finding;
use super::source::Source;

// Spelled in pieces, so that this file passes its own check.
const MACROS: [&str; 3] = [concat!("to", "do!"), concat!("unimple", "mented!"), "dbg!"];
const IGNORED: &str = concat!("#[ig", "nore");
const MARKS: [&str; 2] = [concat!("FIX", "ME"), concat!("X", "XX")];

/// Macros, attributes and remarks that say "not finished".
pub(super) fn check(source: &Source) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (number, line) in source.code_lines() {
        for name in MACROS.iter().filter(|name| has_word(line, name)) {
            let advice = format!("`{name}` is unfinished work: finish it or take it out");
            findings.push(Finding::new(&source.path, number, advice));
        }
        if line.contains(IGNORED) {
            let advice =
                "a test that does not run proves nothing: make it fast enough, or delete it";
            findings.push(Finding::new(&source.path, number, advice));
        }
    }
    for (number, line) in source.lines() {
        for mark in MARKS.iter().filter(|mark| has_word(line, mark)) {
            let advice = format!("`{mark}`: do it now, or open an issue and take the remark out");
            findings.push(Finding::new(&source.path, number, advice));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(path: &str, text: &str) -> usize {
        check(&Source::new(path, text)).len()
    }

    #[test]
    fn unfinished_work_is_found() {
        for name in MACROS {
            assert_eq!(findings("a.rs", &format!("fn f() {{ {name}() }}")), 1);
            assert_eq!(findings("a.rs", &format!("fn f() {{ not_{name}() }}")), 0);
        }
        assert_eq!(findings("a.rs", &format!("{IGNORED} = \"slow\"]")), 1);
        for mark in MARKS {
            assert_eq!(findings("a.rs", &format!("// {mark}: later")), 1);
            assert_eq!(findings("a.py", &format!("# {mark} later")), 1);
            assert_eq!(findings("a.sh", &format!("mktemp a.X{mark}")), 0);
        }
    }

    #[test]
    fn what_is_only_spoken_of_passes() {
        assert_eq!(findings("a.rs", &format!("/// Not {}().", MACROS[0])), 0);
        assert_eq!(findings("a.rs", &format!("let s = \"{IGNORED}]\";")), 0);
    }
}
