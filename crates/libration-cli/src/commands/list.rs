//! `libration list`.

use libration::AnyMethod;
use libration::catalog::{ENTRIES, Entry};
use libration::integrator::Exact;
use libration_analyze::system_summary::{SummaryTask, SystemSummary};
use libration_lab::STUDIES;
use libration_report::printable::printable;
use libration_settings::EquationExample;
use libration_settings::equations::EquationSystem;
use libration_study::Study;
use serde_json::{Value, json};

use super::{equation_file, presets};
use crate::args::ListArgs;
use crate::error::Failure;
use crate::terminal;

/// Lists studies, systems and integrators.
pub(crate) fn run(args: &ListArgs) -> Result<(), Failure> {
    if let Some(file) = &args.file {
        let summary = SystemSummary::new(&equation_file::read(file, &[])?);
        let text = match args.json {
            true => format!("{:#}\n", json!(summary)),
            false => summary_text(&summary),
        };
        return Ok(terminal::print(&text)?);
    }
    if args.presets {
        return Ok(terminal::print(&presets::listing(args.json))?);
    }
    if let Some(name) = &args.examples {
        return Ok(terminal::print(&examples(name, args.json)?)?);
    }
    let listing = if args.json { format!("{:#}\n", as_json()) } else { as_text() };
    terminal::print(&listing)?;
    Ok(())
}

/// Returns the file of an example, or without a name one line for each.
fn examples(name: &str, json: bool) -> Result<String, Failure> {
    if let Some(example) = EquationExample::find(name) {
        return Ok(example.text.to_owned());
    }
    let mut all = Vec::new();
    for EquationExample { name, text } in EquationExample::ALL {
        let system = EquationSystem::parse(text, name, &[]).map_err(Failure::run)?;
        all.push((name, system.description));
    }
    let named: Vec<(&str, &str)> =
        all.iter().map(|(name, about)| (*name, about.as_str())).collect();
    let value = |(name, about): &(&str, &str)| json!({ "name": name, "description": about });
    Ok(match json {
        true => format!("{:#}\n", Value::Array(named.iter().map(value).collect())),
        false => lines(&named),
    })
}

fn as_json() -> Value {
    let study = |study: &&dyn Study| json!({ "name": study.name(), "question": study.question() });
    let integrator = |method: AnyMethod| {
        json!({
            "name": method.name(),
            "order": method.order(),
            "summary": method.summary(),
            "source": method.source(),
        })
    };
    // An exact step has no order.
    let exact = json!({ "name": Exact::NAME, "order": null, "summary": Exact::SUMMARY });
    json!({
        "studies": STUDIES.studies.iter().map(study).collect::<Vec<_>>(),
        "systems": ENTRIES.map(system_json),
        "integrators": AnyMethod::all().chain(AnyMethod::tables()).map(integrator).chain([exact]).collect::<Vec<_>>(),
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
    let studies: Vec<_> = STUDIES.studies.iter().map(|s| (s.name(), s.question())).collect();
    let tables: Vec<_> = AnyMethod::tables().map(|m| (m.name(), m.summary())).collect();
    let integrators = AnyMethod::all().map(|m| (m.name(), m.summary()));
    let integrators: Vec<_> = integrators.chain([(Exact::NAME, Exact::SUMMARY)]).collect();
    let systems: String = ENTRIES.iter().map(|entry| system_text(entry)).collect();
    let (studies, integrators, tables) = (lines(&studies), lines(&integrators), lines(&tables));
    format!(
        "Studies\n{studies}\nSystems\n{systems}\nIntegrators\n{integrators}\nPublished methods (sources with --json)\n{tables}"
    )
}

/// Returns one line per name.
fn lines(names: &[(&str, &str)]) -> String {
    let width = names.iter().map(|(name, _)| name.len()).max().unwrap_or_default();
    names.iter().map(|(name, about)| line(&format!("  {name:width$}  "), about)).collect()
}

/// Returns a line for the system, and one per parameter.
fn system_text(system: &Entry) -> String {
    let dimensions = match (system.dimensions.start(), system.dimensions.end()) {
        (1, 1) => "1 dimension".to_owned(),
        (low, high) if low == high => format!("{low} dimensions"),
        (low, high) => format!("{low} to {high} dimensions"),
    };
    let about = format!("{} ({dimensions})", system.summary);
    let parameters = system.parameters.iter().map(|p| {
        let label = format!("    {:<9}  {:>4} {:<9}  ", p.name, p.default, p.unit);
        line(&label, &format!("{}; {}", p.summary, p.allowed))
    });
    line(&format!("  {}  ", system.name), &about) + &parameters.collect::<String>()
}

/// Returns `label` and `text`, wrapped at the width of the page.
fn line(label: &str, text: &str) -> String {
    const PAGE: usize = 100;
    // Width in characters, not in bytes.
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

/// The largest number of characters of names, as far as a line has room.
fn widest<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or_default().min(COLUMN)
}

/// Largest width of a column. A format has room for widths of 16 bits only.
const COLUMN: usize = 60;

/// Returns the properties of a system by equations.
fn summary_text(summary: &SystemSummary) -> String {
    let SystemSummary { name, description, states, parameters, inputs, .. } = summary;
    let mut text = match description.is_empty() {
        true => format!("{}\n", printable(name)),
        false => line(&format!("{}: ", printable(name)), description),
    };
    text += "\nStates at the start\n";
    let width = widest(states.iter().map(|state| state.name.as_str()));
    for state in states {
        let [name, unit] = [&state.name, &state.unit].map(|text| printable(text));
        let line = format!("  {name:width$}  {} {unit}", state.start);
        text += &format!("{}\n", line.trim_end());
    }
    if !parameters.is_empty() {
        text += "\nParameters\n";
        let width = widest(parameters.iter().map(|p| p.name.as_str()));
        for p in parameters {
            let [name, unit] = [&p.name, &p.unit].map(|text| printable(text));
            let row = format!("  {name:width$}  {} {unit}", p.value);
            text += &format!("{}\n", row.trim_end());
        }
    }
    if !inputs.is_empty() {
        text += &format!("\nInputs: {}\n", printable(&inputs.join(", ")));
    }
    let forces = match summary.positional {
        true => "depend on positions only",
        false => "depend on velocities",
    };
    let kind = match summary.polynomial_degree {
        Some(0 | 1) => "linear".to_owned(),
        Some(degree) => format!("polynomials of degree {degree}"),
        None => "no polynomials".to_owned(),
    };
    let time = if summary.time_dependent { "; they depend on time" } else { "" };
    text += &format!(
        "\nEquations: {kind}; accelerations {forces}{time}; {} operations\n",
        summary.operations
    );
    if !summary.smooth {
        text +=
            "They have kinks or jumps: what theory derives from derivatives holds between them.\n";
    }
    if !summary.energy {
        text += "There is no energy: nothing is said of its drift.\n";
    }
    text += &format!("At the start the largest rate of a velocity is {}.\n", summary.rate_at_start);
    match &summary.eigenvalues_at_start {
        None => text += "There a derivative is not finite.\n",
        Some(values) => {
            text += "Linearised there, which need be no equilibrium, the eigenvalues in 1/s are\n";
            for [re, im] in values.iter().filter(|[_, im]| *im >= 0.0) {
                let pair = if *im > 0.0 { format!(" ± {im:.6}i") } else { String::new() };
                text += &format!("  {re:.6}{pair}\n");
            }
        }
    }
    if let Some(SummaryTask { observe, reward, terminated, .. }) = &summary.task {
        text += &format!("\nTask: observes {}; reward {reward}", observe.join(", "));
        if !terminated.is_empty() {
            text += &format!("; over where {}", terminated.join(" or "));
        }
        text += "\n";
    }
    text
}
