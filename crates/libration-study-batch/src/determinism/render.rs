//! The chapter on determinism.

use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::{Record, RecordError};

use crate::bit_comparison;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Determinism".into();
    let kept = record.findings.iter().filter(|f| f.id.starts_with("determinism.kept."));
    let (all, held) = kept.fold((0, 0), |(all, held), f| (all + 1, held + usize::from(f.agrees())));
    page.answer = format!(
        "A result depends on the system, the start, the time step, the seed, the float type and the order of operations in a \
         formula. It does not depend on threads, instruction sets, the number of trajectories or the number of steps per \
         call: {held} of {all} such changes preserve every bit."
    );
    page.paragraph(
        "Each row changes one condition and compares the bits of all results. The trajectories are those of the \
         oscillator of the source with symplectic Euler in f32 from thousands of starts. If the row mentions them, there \
         is jitter of the steps, a different rate for each clock, and a feedback with a latency of one and a half \
         steps.",
    );
    page.table(bit_comparison::table(record)?, 4);
    page.paragraph(
        "Formulas that are equal in exact arithmetic differ in floats: a product computed before the loop, a \
         fused multiply-add, or a sum in parts changes the result. The engine therefore does not fuse \
         or reorder operations, calls no function of the platform within a step, and sums over \
         trajectories in an order that is independent of threads.",
    );
    page.action(
        "Recompute a report and compare all its bits: `libration verify libration-report`.",
    );
    let fused = record.finding("determinism.broken.fused").ok().map(|f| f.measured);
    if let Some(fused) = fused.filter(|fused| *fused > 0.0) {
        page.action(format!(
            "Disable fused multiply-add in your program if its bits must agree with others: it changes {} trajectories here.",
            number(fused, 8)
        ));
    }
    Ok(())
}
