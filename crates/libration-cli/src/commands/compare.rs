//! `libration compare`.

use std::fmt::Write as _;
use std::path::Path;

use libration_lab::{Change, ComparedResults, ResultsComparison};
use libration_report::record::Verdict;
use serde_json::json;

use super::digits::short;
use crate::args::CompareArgs;
use crate::error::Failure;
use crate::terminal;

/// Version of the JSON format.
const SCHEMA: &str = "libration.compare/1";

/// Compares two results and prints what differs. Fails if something became worse.
pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let (before, after) = (read(&args.before)?, read(&args.after)?);
    let comparison = ResultsComparison::new(&before, &after, args.noise);
    let text = match args.json {
        true => {
            let mut value = serde_json::to_value(&comparison).map_err(Failure::run)?;
            value["schema"] = json!(SCHEMA);
            format!("{value:#}\n")
        }
        false => describe(&comparison),
    };
    terminal::print(&text)?;
    match comparison.regressions.len() {
        0 => Ok(()),
        1 => Err(Failure::run("a finding became worse")),
        n => Err(Failure::run(format!("{n} findings became worse"))),
    }
}

fn read(path: &Path) -> Result<ComparedResults, Failure> {
    let file = if path.is_dir() { path.join("results.json") } else { path.to_owned() };
    let text = ComparedResults::read_text(&file)
        .map_err(|error| Failure::usage(format!("cannot read `{}`: {error}", file.display())))?;
    ComparedResults::parse(&text)
        .map_err(|reason| Failure::usage(format!("`{}`: {reason}", file.display())))
}

// Writing into a string cannot fail.
fn describe(comparison: &ResultsComparison) -> String {
    let ResultsComparison { conditions, same, within, regressions, improvements, changed, .. } =
        comparison;
    let mut text =
        format!("{same} findings are the same, {within} within their tolerance or noise\n");
    for condition in conditions {
        let (key, before, after) = (&condition.key, &condition.before, &condition.after);
        let _ = writeln!(text, "{key} differs: {before}, then {after}");
    }
    for (title, changes) in
        [("worse", regressions), ("better", improvements), ("different", changed)]
    {
        if !changes.is_empty() {
            let _ = writeln!(text, "\n{title}");
        }
        for change in changes {
            let _ = writeln!(text, "  {}\n    {}", change.id, sentence(change));
        }
    }
    for (title, ids) in [("first", &comparison.only_before), ("second", &comparison.only_after)] {
        if !ids.is_empty() {
            let _ = writeln!(text, "\nonly in the {title}: {}", ids.join(", "));
        }
    }
    text
}

fn sentence(change: &Change) -> String {
    let unit = if change.unit == "1" { String::new() } else { format!(" {}", change.unit) };
    let numbers = format!("{}{unit}, then {}{unit}", short(change.before), short(change.after));
    let ratio = change.after / change.before;
    let ratio = if ratio.is_finite() { format!(", {} times", short(ratio)) } else { String::new() };
    let verdict = match change.verdicts {
        [Verdict::Agrees, Verdict::Disagrees] => "agreed with theory, now disagrees: ",
        [Verdict::Disagrees, Verdict::Agrees] => "disagreed with theory, now agrees: ",
        [Verdict::Disagrees, Verdict::Disagrees] => "disagrees with theory, as before: ",
        _ => "",
    };
    format!("{verdict}{numbers}{ratio}; {}", change.text)
}
