//! An audit as an HTML page.

use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::{Cell, Table};
use libration_report::report;

use crate::mode_plane::mode_plane;
use crate::{Match, ProbeReport};

/// The audit as an HTML page.
pub fn page(audit: &ProbeReport) -> String {
    let mut page = Page { title: format!("Audit of a step: {}", audit.title), ..Page::default() };
    page.answer.clone_from(&audit.answer);
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
    let sub = format!(
        "{} states · inputs {} · dt = {} s · {} steps · `libration probe`",
        audit.states.len(),
        if audit.inputs.is_empty() { "none".into() } else { audit.inputs.join(", ") },
        number(audit.dt, 4),
        audit.calls,
    );
    report::render_page(&page, &sub)
}

fn findings(page: &mut Page, audit: &ProbeReport) {
    page.heading("What should be changed?");
    if audit.findings.is_empty() {
        page.paragraph("Nothing: the audit has no finding.");
    } else {
        let mut table = Table::new("findings", &["finding", "kind", "evidence"]);
        for finding in &audit.findings {
            let kind = if finding.is_fault { "fault" } else { "warning" };
            table.push([finding.kind.into(), kind.into(), finding.text.clone().into()]);
        }
        page.table(&table, 4);
    }
    for note in &audit.notes {
        page.note(format!("{note}."));
    }
}

fn modes(page: &mut Page, audit: &ProbeReport) {
    if audit.modes.is_empty() {
        return;
    }
    page.heading("How do the modes of the step differ from those of the system?");
    page.paragraph(
        "The system is the limit of small steps. Numerical damping is the damping ratio that the step adds; where it is negative, the \
         step takes damping away. A mode with |z| above 1 grows.",
    );
    let columns = [
        "mode in",
        "|z|",
        "growth rate, step (1/s)",
        "system (1/s)",
        "frequency, step (Hz)",
        "system (Hz)",
        "numerical damping",
    ];
    let mut table = Table::new("modes", &columns);
    let known = |x: Option<f64>| x.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 5));
    for mode in &audit.modes {
        let flow = mode.flow;
        table.push([
            mode.names().into(),
            Cell::rounded(mode.radius, 7),
            Cell::rounded(mode.step.growth_rate, 5),
            known(flow.map(|flow| flow.growth_rate)),
            Cell::rounded(mode.step.frequency, 5),
            known(flow.map(|flow| flow.frequency)),
            known(mode.numerical_damping),
        ]);
    }
    page.table(&table, 7);
    page.figure(mode_plane(audit));
}

fn latency(page: &mut Page, audit: &ProbeReport) {
    if audit.hidden_latency.is_empty() {
        return;
    }
    page.heading("Which latency is hidden in the step?");
    page.paragraph(
        "A command may be used late, and the integrator itself delays its effect. Its delay is that beyond the exact motion under the same \
         held command, by the phase of the state that responds most.",
    );
    let columns = [
        "input",
        "late by (steps)",
        "late by (s)",
        "delay of the integrator (s)",
        "of",
        "total (s)",
    ];
    let mut table = Table::new("latency", &columns);
    for latency in &audit.hidden_latency {
        table.push([
            latency.input.clone().into(),
            Cell::rounded(latency.late_steps, 4),
            Cell::rounded(latency.late, 4),
            latency.integrator_delay.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 4)),
            latency.state.clone().unwrap_or_else(|| "—".into()).into(),
            Cell::rounded(latency.total, 4),
        ]);
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
            let first = audit.first_change.map(|step| Cell::from(step.to_string()));
            table.push([
                audit.input.clone().into(),
                Cell::rounded(*delay, 6),
                count.to_string().into(),
                first.unwrap_or_else(|| Cell::absent("none")),
            ]);
        }
    }
    page.table(&table, 6);
}

fn integrator(page: &mut Page, audit: &ProbeReport) {
    let (Some(order), Some(recognition)) = (&audit.order, &audit.recognition) else { return };
    page.heading("Which integrator is it?");
    let estimates = match order.estimates.is_empty() {
        true => "none, the step is exact".into(),
        false => order.estimates.iter().map(|x| format!("{x:.3}")).collect::<Vec<_>>().join(", "),
    };
    page.paragraph(format!("Estimates of the order from halved steps: {estimates}."));
    page.paragraph(format!(
        "Each candidate steps the same system from a displaced state, whose rates are the limit of short steps of the simulator; errors of \
         the rates explain distances up to {:.1e}.",
        recognition.by_results.allowed
    ));
    candidates(page, "integrators", &recognition.by_results);
    if let Some(by_matrix) = &recognition.by_matrix {
        page.paragraph(format!(
            "The same for small deviations, by the matrix of the step; errors explain distances up to {:.1e}.",
            by_matrix.allowed
        ));
        candidates(page, "integrators-linear", by_matrix);
    }
}

fn candidates(page: &mut Page, name: &str, found: &Match) {
    let mut table = Table::new(name, &["integrator", "distance from the step", "agrees"]);
    // The others are farther, and in the results.
    for candidate in found.candidates.iter().take(8) {
        let agrees = if found.methods.contains(&candidate.method) { "yes" } else { "no" };
        table.push([
            candidate.title.clone().into(),
            Cell::rounded(candidate.distance, 3),
            agrees.into(),
        ]);
    }
    page.table(&table, 3);
}

fn defects(page: &mut Page, audit: &ProbeReport) {
    let Some(defects) = &audit.defects else { return };
    page.heading("What does the step not conserve?");
    let mut table = Table::new("defects", &["quantity", "step", "system or half the step"]);
    let known = |x: Option<f64>| x.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 4));
    table.push([
        "rate of phase-space volume (1/s)".into(),
        Cell::rounded(defects.volume_rate, 4),
        known(defects.flow_volume_rate),
    ]);
    table.push(["defect of symplecticity".into(), known(defects.symplecticity), Cell::absent("—")]);
    table.push([
        "defect of reversibility".into(),
        known(defects.reversibility),
        known(defects.reversibility_halved),
    ]);
    if let Some(energy) = &defects.energy {
        let name = format!("relative rate of the energy (1/s), {}", energy.reason.text());
        table.push([name.into(), Cell::rounded(energy.rate, 4), known(energy.rate_halved)]);
    }
    page.table(&table, 4);
}

fn bits(page: &mut Page, audit: &ProbeReport) {
    page.heading("Are the results the same bits again?");
    let mut table = Table::new("bits", &["comparison", "result"]);
    for check in &audit.bits.checks {
        let result = match &check.difference {
            None => "the same bits".to_owned(),
            Some(d) => format!("{} numbers differ, first {}", d.differing, d.place()),
        };
        table.push([check.name.clone().into(), result.into()]);
    }
    page.table(&table, 4);
    if let Some(rounding) = &audit.bits.rounding {
        page.paragraph(format!(
            "Rounding of a step relative to its results: {:.1e}.",
            rounding.results
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
    let rest = &audit.equilibrium;
    let holds = if rest.holds { "It is an equilibrium" } else { "It is no equilibrium" };
    let mut text = format!(
        "{holds}: the largest change in a step is {:.1e} ({}). The estimated relative error of the matrices is {:.1e}.",
        rest.change, rest.state, audit.jacobian_error
    );
    if let Some(confirmation) = &audit.confirmation {
        text += &format!(
            " A run of {} steps from a deviation of {:.0e} follows them to {:.1e}.",
            confirmation.steps, confirmation.displacement, confirmation.error
        );
    }
    if let Some(reference) = &audit.reference {
        text += &format!(
            " The matrices of {} differ from it by at most {:.1e} of the largest entry of a row.",
            reference.source, reference.difference
        );
    }
    page.paragraph(text);
}
