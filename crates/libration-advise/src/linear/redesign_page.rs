//! The redesigned controller on the page of an advice.

use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::{Cell, Table};

use super::page::{channel_cell, margins_table};
use super::{LinearAdvice, RedesignLimit, StableRange};

/// Adds the controller of least cost for the stated timing, if there is one.
pub(super) fn add(page: &mut Page, advice: &LinearAdvice) {
    let Some(redesign) = &advice.redesign else { return };
    page.heading("A controller for this timing");
    page.paragraph(format!("{}. {}", redesign.method, advice.redesign_effect()));
    for note in &redesign.notes {
        page.paragraph(format!("Note: {note}."));
    }
    let columns = ["imperfection", "channel", "stated", "stable", "redesigned: stable", "unit"];
    let mut table = Table::new("redesign", &columns);
    let stable = |range: Option<StableRange>, limit: &RedesignLimit| match range {
        Some(_) => Cell::from(limit.in_words(range)),
        None => Cell::absent(limit.in_words(range)),
    };
    for limit in &redesign.limits {
        table.push([
            limit.kind.name().into(),
            channel_cell(&limit.channel),
            number(limit.stated, 4).into(),
            stable(limit.given, limit),
            stable(limit.redesigned, limit),
            limit.unit.into(),
        ]);
    }
    page.paragraph(
        "Sizes of each imperfection with which the loop is stable while all others are as stated:",
    );
    page.table(&table, 4);
    if !redesign.margins.is_empty() {
        page.paragraph("Gain and phase margins of the redesigned loop, with the stated latencies:");
        page.table(&margins_table("redesign-margins", &redesign.margins), 4);
    }
    page.paragraph("To paste into the request file in place of the controller:");
    page.code(&*redesign.toml);
}
