//! The chapter on memory.

use libration_report::notation::{number, seconds};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::MIB;
use super::figures::growth;
use crate::reported::EXAMPLES;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Memory of rollouts".into();
    let each = record.finding("memory.each")?.measured;
    let [example, _] = EXAMPLES;
    let taken = record.finding(&format!("memory.{}", example.name()))?.measured / MIB;
    page.answer = format!(
        "{} bytes for each transition of each environment: {} are {} MiB. It grows in proportion to the environments \
         and to the horizon, and not exponentially.",
        number(each, 2),
        example.title(),
        number(taken, 3)
    );
    if let Ok(full) = record.finding("memory.full") {
        let after = seconds(full.measured, 2);
        page.answer.push_str(&format!(
            " At the rate of this machine its memory is full after {after}, if everything is kept."
        ));
        page.highlights
            .push(Highlight { value: after, text: "until kept rollouts fill this machine".into() });
    }
    page.paragraph(
        "A rollout is planned before anything is allocated, so that a size that does not fit is refused with what \
         would. The plan is compared with the tensors that are then held, field by field and to the byte.",
    );
    page.figure(growth(record)?.number("9.10"));
    page.table(record.table("rollouts in memory")?, 3);
    page.paragraph(
        "The source takes 16 bytes for a transition in §6.5 and 17 in table 9.11, lists fields of 13, and says MB where \
         it means MiB; its numbers of §6.5 mix all of these. Numbers of half the size do not halve a transition, \
         since a flag remains a byte, and what a learner needs beside them (log-probabilities, values) costs more \
         than that saves.",
    );
    page.table(record.table("bytes of a transition")?, 3);
    Ok(())
}
