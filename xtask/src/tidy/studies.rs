//! A study stands alone: it can be read, changed and taken out without any other.

use std::collections::BTreeSet;

use super::code::{line_of, words};
use super::crate_file::File;
use super::crate_modules::{self, Crate};
use super::finding::Finding;
use super::source::Source;

/// Names that a study, or a module that studies share, takes from another study of its crate, or passes on from it.
pub(super) fn check(sources: &[Source]) -> Vec<Finding> {
    crate_modules::crates(sources).iter().flat_map(crossings).collect()
}

fn crossings(within: &Crate<'_>) -> Vec<Finding> {
    let tops = within.files.iter().filter(|file| implements_study(file));
    let studies: BTreeSet<&str> = tops.filter_map(top).collect();
    let study = |file: usize| top(&within.files[file]).filter(|top| studies.contains(top));
    let mut findings = Vec::new();
    for taken in within.uses() {
        let file = &within.files[taken.from];
        // The root names all studies.
        let (Some(own), Some(other)) = (top(file), study(taken.to)) else { continue };
        if own != other {
            let kind = if studies.contains(own) { "study" } else { "shared module" };
            let advice = format!(
                "the {kind} `{own}` takes `{}` from the study `{other}`: move what both need to a module \
                 that is no study, or to crates/libration-study",
                taken.name,
            );
            findings.push(Finding::new(
                &file.source.path,
                line_of(&file.code, taken.offset),
                advice,
            ));
        }
    }
    findings
}

/// The module of the root that a file belongs to; none for the root.
fn top<'a>(file: &'a File<'_>) -> Option<&'a str> {
    file.module.first().map(String::as_str)
}

fn implements_study(file: &File<'_>) -> bool {
    let implements = |at: usize| file.code[at + "Study".len()..].starts_with(" for ");
    words(&file.code, "Study").any(implements)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "mod part; pub struct It; impl crate::Study for It {}";

    /// The lines of the findings in `text`, a file of the study `drift`.
    fn lines(text: &str) -> Vec<usize> {
        lines_of("drift/part", text)
    }

    fn lines_of(name: &str, text: &str) -> Vec<usize> {
        let crates = "crates/libration-study-motion/src";
        let sources = [
            (
                "lib",
                "mod alone; mod drift; mod error; mod shared; mod subject; pub use error::It as Error;",
            ),
            ("drift/mod", STUDY),
            (name, text),
            ("error/mod", STUDY),
            ("error/part", "pub fn f() {}"),
            ("subject/mod", "pub struct Subject; pub fn f() {}"),
        ];
        let sources = sources.map(|(name, text)| Source::new(&format!("{crates}/{name}.rs"), text));
        check(&sources).iter().map(|finding| finding.place().1).collect()
    }

    #[test]
    fn another_study_is_found_by_every_way_to_name_it() {
        for text in [
            "use crate::error::It;",
            "fn f(x: crate::error::part::X) {}",
            "pub(crate) use super::super::error::It;",
            "use crate::{error::{self, It}, subject};",
            "use crate::error as e; fn f() { e::part::f() }",
            "use crate::Error;",
        ] {
            assert_eq!(lines(&format!("\n{text}")), [2], "{text}");
        }
    }

    #[test]
    fn a_study_in_one_file_and_a_shared_module_may_not_take_from_a_study_either() {
        let uses = "\nuse crate::error::It;";
        assert_eq!(lines_of("alone", &format!("{uses} impl crate::Study for Alone {{}}")), [2]);
        assert_eq!(lines_of("shared", uses), [2]);
    }

    #[test]
    fn its_own_parts_shared_modules_and_comments_pass() {
        for text in [
            "use super::It; use crate::drift::It as Own;",
            "use crate::subject::{self, Subject}; fn f() { subject::f() }",
            "// crate::error::It",
            "#[cfg(test)] mod tests { use crate::error::It; }",
        ] {
            assert!(lines(text).is_empty(), "{text}");
        }
    }
}
