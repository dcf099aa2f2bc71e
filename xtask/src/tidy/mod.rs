//! `cargo xtask tidy`: rules about the sources that no compiler checks.
//!
//! A finding names the place and says what to change. One file a rule, its test at the foot.

pub(crate) mod code;
mod finding;
mod integrator;
mod length;
mod machine;
mod manifest;
mod purity;
mod safety;
mod simd;
mod source;
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

/// Reads the tracked sources and prints what breaks a rule.
pub(crate) fn run() -> Outcome {
    let sources = source::tracked(&workspace::root())?;
    let mut findings: Vec<Finding> =
        sources.iter().flat_map(|source| RULES.iter().flat_map(|rule| rule(source))).collect();
    findings.extend(integrator::check(&sources));
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
