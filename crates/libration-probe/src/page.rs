//! An audit as an HTML page.

use libration_report::notation::{number, plural};
use libration_report::page::Page;
use libration_report::record::{Cell, Table};
use libration_report::report;
use libration_report::verdict::Outcome;

use crate::ProbeReport;
use crate::findings_page::findings;
use crate::first_screen::{actions, numbers, title};
use crate::integrator_page::{defects, integrator};
use crate::live_setting::{NO_LIVE_SECTION, live_settings};
use crate::mode_plane::mode_plane;
use crate::summary::{capitalised, error_in_words};

/// The audit as an HTML page.
pub fn page(audit: &ProbeReport) -> String {
    let mut page = Page { title: title(audit), ..Page::default() };
    page.answer.clone_from(&audit.answer);
    page.live = live_settings(audit);
    if audit.verdict.outcome == Outcome::Unknown {
        page.note(NO_LIVE_SECTION);
    }
    page.highlights = numbers(audit);
    page.actions = actions(audit);
    findings(&mut page, audit);
    modes(&mut page, audit);
    latency(&mut page, audit);
    integrator(&mut page, audit);
    defects(&mut page, audit);
    bits(&mut page, audit);
    linearisation(&mut page, audit);
    if !audit.repeat_command.is_empty() {
        page.heading("How is the audit repeated?");
        page.code(audit.repeat_command.clone());
    }
    let simulator = audit.version.as_ref().map(|version| format!(" · {version}"));
    let sub = format!(
        "{} · {} · dt = {} s · {}{} · `libration probe` {}",
        plural(audit.states.len(), "state"),
        plural(audit.inputs.len(), "input"),
        number(audit.dt, 4),
        plural(usize::try_from(audit.calls).unwrap_or(usize::MAX), "step"),
        simulator.unwrap_or_default(),
        audit.libration_version,
    );
    report::render_page(&page, &sub)
}

fn modes(page: &mut Page, audit: &ProbeReport) {
    if audit.modes.is_empty() {
        return;
    }
    let has_flow = audit.modes.iter().any(|mode| mode.flow.is_some());
    page.heading(match has_flow {
        true => "How do the modes of the step differ from those of the system?",
        false => "Which modes has the step?",
    });
    page.paragraph(match has_flow {
        true => {
            "The system is the limit of small steps. Numerical damping is the damping ratio that the step adds; where it is negative, the \
             step takes damping away. A mode with |z| above 1 grows."
        }
        false => {
            "The limit of small steps is unknown, and with it the modes of the system. A mode with |z| above 1 grows."
        }
    });
    let of_step = ["mode in", "|z|", "growth rate (1/s)", "frequency (Hz)"];
    let of_both = [
        "mode in",
        "|z|",
        "growth rate, step (1/s)",
        "system (1/s)",
        "frequency, step (Hz)",
        "system (Hz)",
        "numerical damping",
    ];
    let mut table = Table::new("modes", if has_flow { &of_both[..] } else { &of_step });
    for mode in &audit.modes {
        let flow = mode.flow;
        let name = Cell::from(mode.names());
        let size = Cell::rounded(mode.radius, 7);
        let [growth, frequency] =
            [mode.step.growth_rate, mode.step.frequency].map(|x| Cell::rounded(x, 5));
        table.push(match has_flow {
            false => vec![name, size, growth, frequency],
            true => vec![
                name,
                size,
                growth,
                known(flow.map(|flow| flow.growth_rate), 5),
                frequency,
                known(flow.map(|flow| flow.frequency), 5),
                known(mode.numerical_damping, 3),
            ],
        });
    }
    page.table(&table, 5);
    page.figure(mode_plane(audit));
}

/// A number, or a dash where there is none.
fn known(x: Option<f64>, digits: usize) -> Cell {
    x.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, digits))
}

fn latency(page: &mut Page, audit: &ProbeReport) {
    if audit.hidden_latency.is_empty() {
        return;
    }
    page.heading("Which latency is hidden in the step?");
    let is_late = !audit.delays.is_empty()
        || audit
            .hidden_latency
            .iter()
            .any(|latency| latency.late_steps.is_some_and(|late| late != 0.0));
    let is_known = audit.hidden_latency.iter().any(|latency| latency.integrator_delay.is_some());
    page.paragraph(format!(
        "{} {}",
        match (is_late, audit.hidden_latency.iter().all(|latency| latency.late_steps.is_some())) {
            (true, _) => "Some commands are used late.",
            (false, true) => "Each command is used in the step that receives it.",
            (false, false) => "Whether each command is used in the step that receives it was not examined for all inputs.",
        },
        if is_known {
            "The integrator itself delays the effect of a command: beyond the exact motion under the same held command, by the phase of \
             the state that responds most. A negative delay is an early effect."
        } else {
            "The delay of the integrator is unknown."
        }
    ));
    if !is_late && !is_known {
        return;
    }
    let of_integrator = ["input", "delay of the integrator (s)", "by the phase of"];
    let of_both = [
        &of_integrator[..1],
        &["late by (steps)", "late by (s)"],
        &of_integrator[1..],
        &["total (s)"],
    ]
    .concat();
    let mut table = Table::new("latency", if is_late { &of_both[..] } else { &of_integrator });
    for latency in &audit.hidden_latency {
        let input = Cell::from(latency.input.clone());
        let delay = known(latency.integrator_delay, 3);
        let state = Cell::from(latency.state.clone().unwrap_or_else(|| "—".into()));
        table.push(match is_late {
            false => vec![input, delay, state],
            true => vec![
                input,
                known(latency.late_steps, 4),
                known(latency.late, 4),
                delay,
                state,
                known(latency.total, 4),
            ],
        });
    }
    page.table(&table, 4);
    if audit.delays.is_empty() {
        return;
    }
    page.paragraph(
        "A ramp as the command shows which one each step uses, while the state is held:",
    );
    let columns = ["input", "delay (steps)", "steps", "first other delay at step"];
    let mut table = Table::new("delays", &columns);
    for audit in &audit.delays {
        for (delay, count) in &audit.delays {
            let first = audit.first_change.map(|step| Cell::from(step as u64));
            table.push([
                audit.input.clone().into(),
                Cell::rounded(*delay, 6),
                Cell::from(*count as u64),
                first.unwrap_or_else(|| Cell::absent("none")),
            ]);
        }
    }
    page.table(&table, 6);
}

fn bits(page: &mut Page, audit: &ProbeReport) {
    page.heading("Are the results the same bits again?");
    let mut table = Table::new("bits", &["comparison", "result"]);
    for check in &audit.bits.checks {
        let result = match &check.difference {
            None => "the same bits".to_owned(),
            Some(d) if d.differing == 1 => format!("1 number differs: {}", d.place()),
            Some(d) => format!("{} numbers differ, first {}", d.differing, d.place()),
        };
        table.push([check.name.clone().into(), result.into()]);
    }
    page.table(&table, 4);
    if let Some(rounding) = &audit.bits.rounding {
        page.paragraph(format!(
            "Rounding of a step relative to its results: {}.",
            number(rounding.results, 2)
        ));
    }
}

fn linearisation(page: &mut Page, audit: &ProbeReport) {
    page.heading("Where is the step linearised?");
    let mut table = Table::new("state", &["state", "value"]);
    for (name, value) in audit.states.iter().zip(&audit.state) {
        table.push([name.clone().into(), Cell::rounded(*value, 6)]);
    }
    for (name, value) in audit.inputs.iter().zip(&audit.action) {
        table.push([format!("command {name}").into(), Cell::rounded(*value, 6)]);
    }
    page.table(&table, 6);
    for note in &audit.notes {
        page.note(format!("{}.", capitalised(note)));
    }
    page.paragraph(match audit.step.is_some() {
        true => linearised(audit),
        false => {
            "The step was not linearised: its results are not those of the given state and action."
                .into()
        }
    });
}

fn linearised(audit: &ProbeReport) -> String {
    let rest = &audit.equilibrium;
    let holds = if rest.holds { "It is an equilibrium" } else { "It is no equilibrium" };
    let change = match rest.change {
        0.0 => "no state changes in a step".into(),
        change => format!("the largest change in a step is {} ({})", number(change, 2), rest.state),
    };
    let mut text = format!(
        "{holds}: {change}. The estimated relative error of the matrices is {}.",
        error_in_words(audit.jacobian_error)
    );
    if let Some(confirmation) = &audit.confirmation {
        let follows = match confirmation.error <= 1.0 {
            true => {
                format!("follows them to a relative error of {}", number(confirmation.error, 2))
            }
            false => "does not follow them".into(),
        };
        text += &format!(
            " A run of {} from a deviation of {} {follows}.",
            plural(confirmation.steps, "step"),
            number(confirmation.displacement, 1),
        );
    }
    if let Some(reference) = &audit.reference {
        text += &format!(
            " The matrices of {} differ from it by at most {} of the largest entry of a row.",
            reference.source,
            number(reference.difference, 2)
        );
    }
    text
}
