//! The parts of a report about a system of equations around its chapters.

use libration_analyze::system_summary::{SummaryParameter, SummaryState, SystemSummary};
use libration_report::notation::{number, seconds};
use libration_report::report::{SCOPE_ID, scroll_container};
use libration_report::text::{escape, render_html};

use crate::results::StudiedSystem;
use crate::system_studies::NotApplicable;

/// The system in a line of text.
pub(crate) fn subject(system: &SystemSummary) -> String {
    match system.description.as_str() {
        "" => system.name.clone(),
        description => description.to_owned(),
    }
}

/// The states at the start, the parameters and the turn.
pub(crate) fn states(StudiedSystem { summary: system, turn, .. }: &StudiedSystem) -> String {
    let row = |name: &str, value: f64, unit: &str| {
        format!(
            "<tr><td>{}</td><td class=\"num\">{}</td><td>{}</td></tr>",
            escape(name),
            render_html(&number(value, 6)),
            escape(unit)
        )
    };
    let state = |SummaryState { name, unit, start }: &SummaryState| row(name, *start, unit);
    let states: String = system.states.iter().map(state).collect();
    let parameter =
        |SummaryParameter { name, value, unit }: &SummaryParameter| row(name, *value, unit);
    let parameters: String = system.parameters.iter().map(parameter).collect();
    let table = |head: &str, value: &str, rows: &str| match rows {
        "" => String::new(),
        _ => format!(
            "{}<table><thead><tr><th>{head}</th><th class=\"num\">{value}</th><th>unit</th></tr></thead>\
             <tbody>{rows}</tbody></table></div>\n",
            scroll_container(head)
        ),
    };
    let tables = [table("state", "start", &states), table("parameter", "value", &parameters)];
    let turn = format!(
        "Time steps are fractions of a turn of {}: 2π over the largest eigenvalue of the equations, linearised at the start and at \
         the equilibrium nearest to it; without one, the time in which the state changes by its own size.",
        seconds(*turn, 3)
    );
    format!(
        "<section>\n<h2>The system</h2>\n{}<p>{}</p>\n</section>\n",
        tables.concat(),
        render_html(&turn)
    )
}

/// The studies that do not apply, each with its reason; empty if all do.
pub(crate) fn not_applicable(studies: &[NotApplicable]) -> String {
    if studies.is_empty() {
        return String::new();
    }
    let entry = |NotApplicable { study, because }: &NotApplicable| {
        format!("<li><code>{}</code>: {}.</li>", escape(study), render_html(because))
    };
    let entries: String = studies.iter().map(entry).collect();
    format!(
        "<section>\n<h2 id=\"{SCOPE_ID}\">Studies that do not apply</h2>\n<ul>{entries}</ul>\n</section>\n"
    )
}
