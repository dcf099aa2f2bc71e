//! The redesigned controller on the page of an advice.

use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::{Cell, Table};

use super::page::margins_table;
use super::{LinearAdvice, StableRange};

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
    let stable = |range: Option<StableRange>| {
        range.map_or_else(|| Cell::absent("unstable"), |range| range.in_words().into())
    };
    for limit in &redesign.limits {
        table.push([
            limit.kind.name().into(),
            limit.channel.clone().map_or_else(|| Cell::absent("all"), Cell::from),
            number(limit.stated, 4).into(),
            stable(limit.given),
            stable(limit.redesigned),
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
    for line in redesign.toml.lines() {
        page.paragraph(format!("`{line}`"));
    }
}
