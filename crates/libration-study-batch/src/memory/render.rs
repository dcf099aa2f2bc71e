//! The chapter on memory.

use libration_report::notation::{number, seconds};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::MIB;
use super::figures::growth;
use crate::source_rollouts::EXAMPLES;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Memory of rollouts".into();
    let each = record.finding("memory.each")?.measured;
    let [example, _] = EXAMPLES;
    let taken = record.finding(&format!("memory.{}", example.name()))?.measured / MIB;
    page.answer = format!(
        "{} bytes per transition of an environment: {} take {} MiB. Memory is proportional to the number of environments \
         and to the horizon.",
        number(each, 2),
        example.title(),
        number(taken, 3)
    );
    if let Ok(full) = record.finding("memory.full") {
        let after = seconds(full.measured, 2);
        page.answer.push_str(&format!(
            " At the rate of this machine its memory is full after {after}, if all rollouts are kept."
        ));
        page.highlights.push(Highlight {
            value: after,
            text: "until rollouts fill the memory of this machine".into(),
        });
    }
    page.paragraph(
        "The size of a rollout is computed before any allocation; a size that does not fit is rejected with the size that \
         would fit. The computed size is compared with the allocated tensors, field by field and to the byte.",
    );
    page.figure(growth(record)?.number("9.10"));
    page.table(record.table("rollouts in memory")?, 3);
    page.paragraph(
        "The source assumes 16 bytes per transition in §6.5 and 17 in table 9.11, lists fields of 13 bytes, and writes MB for \
         MiB; the numbers of §6.5 mix these. Floats of half the size do not halve a transition, \
         since a flag remains one byte, and the log-probabilities and values of a learner add more bytes \
         than that saves.",
    );
    page.table(record.table("bytes of a transition")?, 3);
    page.action(match record.finding("memory.full") {
        Ok(full) => format!(
            "Write rollouts to a data set if you keep those of more than {}: `libration rollout --out data --transitions 1e8`.",
            seconds(full.measured, 2)
        ),
        Err(_) => "Write rollouts that exceed the memory to a data set: `libration rollout --out data --transitions 1e8`.".into(),
    });
    Ok(())
}
