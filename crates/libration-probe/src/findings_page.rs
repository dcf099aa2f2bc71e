//! The part of the page of an audit about its findings.

use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::Table;
use libration_report::verdict::Outcome;

use crate::ProbeReport;

/// The table of findings, and what was not examined.
pub(crate) fn findings(page: &mut Page, audit: &ProbeReport) {
    page.heading("What should be changed?");
    if audit.findings.is_empty() {
        page.paragraph(format!("The audit has no finding.{}", longer_step(audit)));
        return limits(page, audit);
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
    limits(page, audit);
}

/// The parts that the audit did not examine.
fn limits(page: &mut Page, audit: &ProbeReport) {
    let limits = audit.verdict.limits();
    if !limits.is_empty() {
        page.paragraph(limits);
    }
}

/// How much longer the step might be; empty if that is unknown.
fn longer_step(audit: &ProbeReport) -> String {
    let is_known = audit.verdict.outcome != Outcome::Unknown;
    let limit = audit.largest_dt.as_ref().filter(|limit| is_known && !limit.grows_always);
    let Some(limit) = limit else {
        return String::new();
    };
    let longest = limit.dt.unwrap_or(limit.tried_up_to);
    if longest <= audit.dt {
        return String::new();
    }
    let is_exact = audit.order.as_ref().is_some_and(|order| order.is_exact);
    format!(
        " The step might be {}{} times as long, {} s, and stay stable at this state{}.",
        if limit.dt.is_some() { "up to " } else { "at least " },
        number(longest / audit.dt, 3),
        number(longest, 4),
        if is_exact { "" } else { "; its errors grow with it" }
    )
}
