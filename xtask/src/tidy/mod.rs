//! `cargo xtask tidy`: rules about the sources that no compiler checks.
//!
//! A finding names the place and says what to change. One file a rule, its test at the foot.

mod circles;
pub(crate) mod code;
mod crate_file;
mod crate_modules;
mod finding;
mod integrator;
mod layers;
mod length;
mod machine;
mod manifest;
mod paths;
mod purity;
mod safety;
mod simd;
mod size;
pub(crate) mod source;
mod studies;
mod test_items;
mod unfinished;
mod whitespace;

use crate::{Outcome, workspace};
use finding::Finding;
use source::Source;

/// Rules that look at one file at a time.
const RULES: [fn(&Source) -> Vec<Finding>; 8] = [
    length::check,
    machine::check,
    manifest::check,
    purity::check,
    safety::check,
    simd::check,
    unfinished::check,
    whitespace::check,
];

/// Rules that look at all files together.
const COMMON_RULES: [CommonRule; 5] =
    [circles::check, integrator::check, layers::check, size::check, studies::check];

type CommonRule = fn(&[Source]) -> Vec<Finding>;

/// Reads the tracked sources and prints what breaks a rule.
pub(crate) fn run() -> Outcome {
    let sources = source::tracked(&workspace::root())?;
    let mut findings: Vec<Finding> =
        sources.iter().flat_map(|source| RULES.iter().flat_map(|rule| rule(source))).collect();
    findings.extend(COMMON_RULES.iter().flat_map(|rule| rule(&sources)));
    findings.sort();
    for finding in &findings {
        println!("{finding}");
    }
    match findings.len() {
        0 => Ok(()),
        1 => Err("1 place to mend".to_owned()),
        n => Err(format!("{n} places to mend")),
    }
}
