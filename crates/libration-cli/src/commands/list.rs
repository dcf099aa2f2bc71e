//! `libration list`.

use libration::Method;
use libration::catalog::{ENTRIES, Entry};
use libration_lab::{Study, studies};
use serde_json::{Value, json};

use crate::args::ListArgs;
use crate::error::Failure;
use crate::terminal;

/// Lists studies, systems and integrators.
pub(crate) fn run(args: &ListArgs) -> Result<(), Failure> {
    let listing = if args.json { format!("{:#}\n", as_json()) } else { as_text() };
    terminal::print(&listing)?;
    Ok(())
}

fn as_json() -> Value {
    let study = |study: &&dyn Study| json!({ "name": study.name(), "question": study.question() });
    let integrator = |method: Method| json!({ "name": method.name(), "order": method.order(), "summary": method.summary() });
    json!({
        "studies": studies::ALL.iter().map(study).collect::<Vec<_>>(),
        "systems": ENTRIES.map(system_json),
        "integrators": Method::ALL.map(integrator),
    })
}

fn system_json(entry: &Entry) -> Value {
    let parameters = entry.parameters.iter().map(|p| {
        json!({
            "name": p.name,
            "unit": p.unit,
            "summary": p.summary,
            "default": p.default,
            "allowed": p.allowed.to_string(),
        })
    });
    json!({
        "name": entry.name,
        "summary": entry.summary,
        "dimensions": { "min": entry.dimensions.start(), "max": entry.dimensions.end() },
        "q": entry.q,
        "v": entry.v,
        "parameters": parameters.collect::<Vec<_>>(),
    })
}

fn as_text() -> String {
    let studies: Vec<_> = studies::ALL.iter().map(|s| (s.name(), s.question())).collect();
    let integrators = Method::ALL.map(|m| (m.name(), m.summary()));
    let mut text = section("Studies", &studies);
    text.push_str(&section("Integrators", &integrators));
    text.push_str("Systems\n");
    ENTRIES.iter().for_each(|entry| text.push_str(&system_text(entry)));
    text
}

/// A heading, and a line for each name.
fn section(heading: &str, lines: &[(&str, &str)]) -> String {
    let width = lines.iter().map(|(name, _)| name.len()).max().unwrap_or_default();
    let mut text = format!("{heading}\n");
    for (name, about) in lines {
        text.push_str(&entry(&format!("  {name:width$}  "), about));
    }
    text + "\n"
}

fn system_text(system: &Entry) -> String {
    let dimensions = match (system.dimensions.start(), system.dimensions.end()) {
        (1, 1) => "1 dimension".to_owned(),
        (low, high) if low == high => format!("{low} dimensions"),
        (low, high) => format!("{low} to {high} dimensions"),
    };
    let mut text =
        entry(&format!("  {}  ", system.name), &format!("{dimensions}; {}", system.summary));
    for p in system.parameters {
        let line = format!("{}; {}", p.summary, p.allowed);
        text.push_str(&entry(
            &format!("    {:<9}  {:>4?} {:<8}  ", p.name, p.default, p.unit),
            &line,
        ));
    }
    text + "\n"
}

/// `text` after `label`, wrapped so that no line is wider than the page.
fn entry(label: &str, text: &str) -> String {
    const PAGE: usize = 100;
    let indent = label.chars().count();
    let (mut lines, mut column) = (label.to_owned(), indent);
    for word in text.split_whitespace() {
        let width = word.chars().count();
        if column > indent && column + width > PAGE {
            lines.truncate(lines.trim_end().len());
            lines.push('\n');
            lines.push_str(&" ".repeat(indent));
            column = indent;
        }
        lines.push_str(word);
        lines.push(' ');
        column += width + 1;
    }
    lines.truncate(lines.trim_end().len());
    lines + "\n"
}
