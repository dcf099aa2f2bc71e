//! The part of the page of an audit about the integrator.

use libration_report::notation::{number, plural};
use libration_report::page::Page;
use libration_report::record::{Cell, Table};

use crate::summary::error_in_words;
use crate::{Match, ProbeReport};

/// Integrators of a table besides those that agree; all are in the results.
const OTHERS: usize = 4;

/// Which integrator the step is, and of which order.
pub(crate) fn integrator(page: &mut Page, audit: &ProbeReport) {
    let (Some(order), Some(recognition)) = (&audit.order, &audit.recognition) else { return };
    page.heading("Which integrator is it?");
    page.paragraph(match order.is_exact {
        true => "Halved steps give the same results: the step is exact, and has no order.".into(),
        false => format!("Estimates of the order from halved steps: {}.", order.in_words()),
    });
    page.paragraph(format!(
        "Each candidate steps the same system from a displaced state, whose rates are the limit of short steps of the simulator; errors of \
         the rates explain distances {}.",
        allowed(recognition.by_results.allowed)
    ));
    candidates(page, "integrators", &recognition.by_results);
    if let Some(by_matrix) = &recognition.by_matrix {
        page.paragraph(format!(
            "The same for small deviations, by the matrix of the step; errors explain distances {}.",
            allowed(by_matrix.allowed)
        ));
        candidates(page, "integrators-linear", by_matrix);
    }
}

/// How large distances are that errors explain.
fn allowed(distance: f64) -> String {
    match error_in_words(distance) {
        unknown if unknown == "unknown" => "of unknown size".into(),
        known => format!("up to {known}"),
    }
}

fn candidates(page: &mut Page, name: &str, found: &Match) {
    let mut table = Table::new(name, &["integrator", "distance from the step", "agrees"]);
    for candidate in found.candidates.iter().take(found.methods.len() + OTHERS) {
        table.push([
            candidate.title.clone().into(),
            Cell::rounded(candidate.distance, 3),
            found.agreement(candidate.method).into(),
        ]);
    }
    page.table(&table, 3);
}

/// What the step does not conserve.
pub(crate) fn defects(page: &mut Page, audit: &ProbeReport) {
    let Some(defects) = &audit.defects else { return };
    page.heading("What does the step not conserve?");
    let mut table = Table::new("defects", &["quantity", "of the step", "for comparison"]);
    let beside = |what: &str, x: Option<f64>| {
        x.map_or_else(|| "—".to_owned(), |x| format!("{what}: {}", number(x, 4)))
    };
    let mut row = |quantity: &str, value: Option<f64>, comparison: String| {
        if let Some(value) = value {
            table.push([quantity.into(), Cell::rounded(value, 4), comparison.into()]);
        }
    };
    let volume = beside("the system", defects.flow_volume_rate);
    row("rate of phase-space volume (1/s)", Some(defects.volume_rate), volume);
    row("defect of symplecticity", defects.symplecticity, "a symplectic step: 0".into());
    let halved = beside("half the step", defects.reversibility_halved);
    row("defect of reversibility", defects.reversibility, halved);
    if let Some(energy) = &defects.energy {
        let reason = energy.reason.text();
        let reason = match energy.rate_halved {
            Some(_) => format!("{}; {reason}", beside("half the step", energy.rate_halved)),
            None => reason.to_owned(),
        };
        if let Some(change) = energy.change {
            let steps = plural(energy.steps, "step");
            row(
                "relative change of the energy",
                Some(change),
                format!("over {steps}; conserved: 0"),
            );
        }
        row("relative rate of the energy (1/s)", Some(energy.rate), reason);
    }
    page.table(&table, 4);
}
