//! An audit as an HTML page.

use libration_report::figure::{Axis, Figure, Mark, Panel};
use libration_report::notation::{number, plural};
use libration_report::page::Page;
use libration_report::record::{Cell, Table};
use libration_report::report;
use libration_report::verdict::Outcome;

use crate::interval::{exponent, interval};
use crate::{EnergyReport, Estimate, PowerLaw, Run};

/// The audit as an HTML page.
pub fn page(audit: &EnergyReport) -> String {
    let mut page = Page { title: title(audit), ..Page::default() };
    page.answer.clone_from(&audit.answer);
    findings(&mut page, audit);
    runs(&mut page, audit);
    laws(&mut page, audit);
    if !audit.repeat_command.is_empty() {
        page.heading("How is the audit repeated?");
        page.code(audit.repeat_command.clone());
    }
    let sub = format!(
        "{} · `libration audit` {}",
        plural(audit.runs.len(), "run"),
        audit.libration_version
    );
    report::render_page(&page, &sub)
}

/// The verdict in a few words.
fn title(audit: &EnergyReport) -> String {
    let titles: Vec<&str> = audit.runs.iter().map(|run| run.title.as_str()).collect();
    let energies = format!("energies of {}", titles.join(", "));
    let kept = audit.tolerance_verdict.as_ref().map(|kept| kept.outcome);
    match audit.verdict.outcome {
        outcome if outcome.is_good() && kept == Some(Outcome::Exceeds) => {
            format!("The {energies} exceed the tolerance")
        }
        outcome if outcome.is_good() && kept == Some(Outcome::Unknown) => {
            format!("Whether the {energies} keep the tolerance is unknown")
        }
        Outcome::Unknown => format!("Whether the {energies} have a fault is unknown"),
        Outcome::Fault => format!("The {energies} have a fault"),
        outcome if outcome.is_good() => format!("The {energies} have no fault that was found"),
        outcome => format!("The {energies}: {outcome}"),
    }
}

fn findings(page: &mut Page, audit: &EnergyReport) {
    page.heading("What should be changed?");
    if audit.findings.is_empty() {
        page.paragraph("The audit has no finding.");
        return;
    }
    let mut table = Table::new("findings", &["finding", "kind", "evidence", "what to change"]);
    for finding in &audit.findings {
        let kind = if finding.is_fault { "fault" } else { "warning" };
        table.push([
            format!("`{}`", finding.kind).into(),
            kind.into(),
            finding.text.clone().into(),
            finding.help.clone().into(),
        ]);
    }
    page.table(&table, 4);
}

fn runs(page: &mut Page, audit: &EnergyReport) {
    page.heading("What does each run show?");
    page.paragraph(
        "Intervals are of 95 % and honour the autocorrelation of the energy. The oscillation is a standard deviation about the drift; a \
         random walk is given by its deviation after one second. Oscillation, drift, walk and deviation are in the unit of the energies.",
    );
    let mut table = Table::new(
        "runs",
        &[
            "run",
            "dt (s)",
            "duration (s)",
            "oscillation",
            "drift per second",
            "random walk in 1 s",
            "largest deviation",
            "correlation time (s)",
        ],
    );
    for run in &audit.runs {
        let walk = run.present_walk().map_or_else(
            || Cell::absent("—"),
            |walk| Cell::rounded(walk.diffusion.value.sqrt(), 3),
        );
        table.push([
            run.title.clone().into(),
            Cell::rounded(run.dt, 4),
            Cell::rounded(run.duration, 4),
            interval(run.oscillation, 3).into(),
            interval(run.drift_rate, 3).into(),
            walk,
            Cell::rounded(run.deviation_from_start, 3),
            run.correlation_time.map_or_else(|| Cell::absent("—"), |time| Cell::rounded(time, 3)),
        ]);
    }
    page.table(&table, 4);
}

fn laws(page: &mut Page, audit: &EnergyReport) {
    page.heading("How do they depend on the time step?");
    let mut table = Table::new("laws", &["part", "exponent of dt", "cause"]);
    let order = |law: Option<PowerLaw>| {
        law.map_or_else(|| Cell::absent("—"), |law| exponent(law.exponent).into())
    };
    let rows = [
        ("oscillation", audit.oscillation_law, audit.oscillation_cause.text()),
        ("drift rate", audit.drift_law, audit.drift_cause.text()),
        ("variance of the walk", audit.walk_law, audit.walk_cause.text()),
    ];
    for (part, law, cause) in rows {
        table.push([part.into(), order(law), cause.into()]);
    }
    page.table(&table, 3);
    if let Some(figure) = figure(audit) {
        page.figure(figure);
    }
}

/// Sizes against the time step; a part that no run resolves has no panel.
fn figure(audit: &EnergyReport) -> Option<Figure> {
    let sizes =
        |id: &str, label: &str, size: &dyn Fn(&Run) -> Option<Estimate>, law: Option<PowerLaw>| {
            let known = |run: &Run| {
                size(run).map(|size| (run.dt, size.value.abs())).filter(|(_, size)| *size > 0.0)
            };
            let (dt, values): (Vec<f64>, Vec<f64>) = audit.runs.iter().filter_map(known).unzip();
            if dt.is_empty() {
                return None;
            }
            let mut panel = Panel::new(Axis::log("dt").unit("s"), Axis::log(label)).title(id);
            if let Some(law) = law {
                let predicted: Vec<f64> =
                    dt.iter().map(|dt| law.coefficient * dt.powf(law.exponent.value)).collect();
                let order = number(law.exponent.value, 3);
                panel =
                    panel.mark(Mark::line(dt.clone(), predicted).label(format!("order {order}")));
            }
            Some(panel.mark(Mark::points(dt, values).label("runs")))
        };
    let oscillation = |run: &Run| Some(run.oscillation);
    let drift = |run: &Run| run.drifts().then_some(run.drift_rate);
    let panels = [
        sizes("oscillation", "standard deviation", &oscillation, audit.oscillation_law),
        sizes("drift", "rate per second", &drift, audit.drift_law),
    ];
    let panels: Vec<Panel> = panels.into_iter().flatten().collect();
    let figure = Figure::new("energy-laws", "Oscillation and drift against the time step")
        .caption("A horizontal line is a part that no shorter step removes; one that falls to the right is rounding.")
        .description("Sizes of the oscillation and of the drift rate of each run against its time step, with the fitted power laws.")
        .columns(panels.len().max(1));
    (!panels.is_empty()).then(|| panels.into_iter().fold(figure, Figure::panel))
}
