//! `libration compare`.

use std::fmt::Write as _;
use std::path::Path;

use libration_lab::{Change, ClaimChange, ComparedResults, ResultsComparison};
use libration_report::printable::printable;
use libration_report::record::{Agreement, ClaimVerdict};
use serde_json::json;

use super::digits::{exact, short};
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
    if comparison.verdict.is_good() {
        return Ok(());
    }
    let failures = comparison.failures();
    Err(Failure::run(match failures.is_empty() {
        true => "no finding was compared".to_owned(),
        false => printable(&failures.join(", ")).to_string(),
    }))
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
    let ResultsComparison { conditions, regressions, moved, improvements, changed, .. } =
        comparison;
    let mut text = format!("{}\n", printable(&comparison.verdict.to_string()));
    for condition in conditions {
        let (key, before, after) = (&condition.key, &condition.before, &condition.after);
        let line = format!("{key} differs: {before}, then {after}");
        let _ = writeln!(text, "{}", printable(&line));
    }
    for (title, changes) in [
        ("worse", regressions),
        ("other predictions", moved),
        ("better", improvements),
        ("different", changed),
    ] {
        if !changes.is_empty() {
            let _ = writeln!(text, "\n{title}");
        }
        for change in changes {
            let sentence = sentence(change);
            let _ = writeln!(text, "  {}\n    {}", printable(&change.id), printable(&sentence));
        }
    }
    if !comparison.claims.is_empty() {
        text += "\nclaims\n";
    }
    for ClaimChange { id, before, after, .. } in &comparison.claims {
        let words = |verdict: &Option<ClaimVerdict>| verdict.map_or("none", ClaimVerdict::name);
        let (before, after) = (words(before), words(after));
        let _ = match before == after {
            true => {
                writeln!(text, "  {}: {before}, on other conditions or findings", printable(id))
            }
            false => writeln!(text, "  {}: {before}, then {after}", printable(id)),
        };
    }
    for (title, ids) in [("first", &comparison.only_before), ("second", &comparison.only_after)] {
        if !ids.is_empty() {
            let _ = writeln!(text, "\nonly in the {title}: {}", printable(&listed(ids)));
        }
    }
    text
}

fn sentence(change: &Change) -> String {
    let Change { before, after, text, .. } = change;
    let shown = |unit: &str| if unit == "1" { String::new() } else { format!(" {unit}") };
    let unit = shown(&change.unit);
    let [first, second] = change.verdicts;
    if second == Agreement::Disagrees {
        let number = |x: Option<f64>| x.map_or_else(|| "none".to_owned(), exact);
        let (predicted, tolerance) = (number(change.predicted), number(change.tolerance));
        let before = match first {
            Agreement::Agrees => format!("agreed with theory at {}, now disagrees", exact(*before)),
            Agreement::Disagrees => format!("disagreed with theory at {}, as now", exact(*before)),
            Agreement::Measured => "disagrees with theory".to_owned(),
        };
        let after = exact(*after);
        return format!(
            "{before}: measured {after}{unit}, predicted {predicted}, tolerance {tolerance}; {text}"
        );
    }
    let unit_before = change.unit_before.as_deref().map_or_else(|| unit.clone(), shown);
    let of = |x: f64, unit: &str| {
        if x.is_nan() { "no number".to_owned() } else { format!("{}{unit}", short(x)) }
    };
    let ratio = after / before;
    let ratio = if change.unit_before.is_some() {
        ", which are not compared".to_owned()
    } else if ratio > 0.0 && ratio.is_finite() {
        format!(", {} times", short(ratio))
    } else {
        String::new()
    };
    let verdict = match (first, second) {
        (Agreement::Disagrees, Agreement::Agrees) => "disagreed with theory, now agrees: ",
        (Agreement::Agrees | Agreement::Disagrees, Agreement::Measured) => {
            "no longer has a prediction: "
        }
        (Agreement::Measured, Agreement::Agrees) => "has a prediction now: ",
        _ => "",
    };
    let number = |x: Option<f64>| x.map_or_else(|| "none".to_owned(), exact);
    let moved = match change.predictions {
        Some([before, after]) if second == Agreement::Agrees && first != Agreement::Measured => {
            format!("prediction changed from {} to {}: ", number(before), number(after))
        }
        _ => String::new(),
    };
    format!(
        "{verdict}{moved}{}, then {}{ratio}; {text}",
        of(*before, &unit_before),
        of(*after, &unit)
    )
}

/// Identifiers; of many the number for each study.
fn listed(ids: &[String]) -> String {
    if ids.len() <= 10 {
        return ids.join(", ");
    }
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for id in ids {
        let study = id.split('.').next().unwrap_or(id);
        match counts.last_mut() {
            Some((last, count)) if *last == study => *count += 1,
            _ => counts.push((study, 1)),
        }
    }
    let counts: Vec<String> =
        counts.iter().map(|(study, count)| format!("{count} of `{study}`")).collect();
    counts.join(", ")
}
