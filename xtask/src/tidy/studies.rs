//! A study stands alone: it can be read, changed and taken out without any other.

use super::code::{line_of, words};
use super::crate_file::File;
use super::crate_modules::{self, Crate};
use super::finding::Finding;
use super::source::Source;

/// Names that a study takes from another study of its crate, or passes on from it.
pub(super) fn check(sources: &[Source]) -> Vec<Finding> {
    crate_modules::crates(sources).iter().flat_map(crossings).collect()
}

fn crossings(within: &Crate<'_>) -> Vec<Finding> {
    let studies: Vec<&File<'_>> = within.files.iter().filter(|file| is_study(file)).collect();
    let study = |file: usize| studies.iter().find(|study| study.is_above(&within.files[file]));
    let mut findings = Vec::new();
    for taken in within.uses() {
        let (Some(own), Some(other)) = (study(taken.from), study(taken.to)) else { continue };
        if own.module != other.module {
            let file = &within.files[taken.from];
            let advice = format!(
                "the study `{}` takes `{}` from the study `{}`: move what both need to a module \
                 that is no study, or to crates/libration-study",
                own.module.join("::"),
                taken.name,
                other.module.join("::"),
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

/// Whether a file is the top of a folder that holds a study.
fn is_study(file: &File<'_>) -> bool {
    let implements = |at: usize| file.code[at + "Study".len()..].starts_with(" for ");
    file.name().ends_with("/mod.rs") && words(&file.code, "Study").any(implements)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "mod part; pub struct It; impl crate::Study for It {}";

    /// The lines of the findings in `text`, a file of the study `drift`.
    fn lines(text: &str) -> Vec<usize> {
        let crates = "crates/libration-study-motion/src";
        let sources = [
            ("lib", "mod drift; mod error; mod subject; pub use error::It as Error;"),
            ("drift/mod", STUDY),
            ("drift/part", text),
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
