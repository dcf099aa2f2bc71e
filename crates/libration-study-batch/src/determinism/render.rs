//! The chapter on determinism.

use libration_report::page::Page;
use libration_report::record::{Record, RecordError};

use crate::changed;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Determinism".into();
    let kept = record.findings.iter().filter(|f| f.id.starts_with("determinism.kept."));
    let (all, held) = kept.fold((0, 0), |(all, held), f| (all + 1, held + usize::from(f.agrees())));
    page.answer = format!(
        "On the system, the start, the time step, the seed, the float type and the order of operations in a formula. \
         Not on threads, instruction sets, the number of trajectories or how many steps are asked for at a \
         time: {held} of {all} such changes leave every bit."
    );
    page.paragraph(
        "Each row changes one thing and compares the bits of all results. Trajectories are those of the \
         source’s oscillator under symplectic Euler in f32 from thousands of starts; where a row says \
         so, their steps jitter, each clock has a rate of its own, and a feedback is one and a half \
         steps late.",
    );
    page.table(changed::table(record)?, 4);
    page.paragraph(
        "What is equal in exact arithmetic is not in floats: a product that is formed ahead of the loop, a \
         fused multiplication and addition, or a sum in parts is another result. So the engine fuses \
         nothing, reorders nothing, calls no function of the platform within a step, and adds over \
         trajectories in an order that no thread changes.",
    );
    Ok(())
}
