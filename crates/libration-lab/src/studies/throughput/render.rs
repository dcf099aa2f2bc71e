//! The chapter on throughput.

use super::figures;
use crate::bench::Implementation;
use crate::notation::number;
use crate::page::{Highlight, Page};
use crate::record::{Record, RecordError, Verdict};

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Throughput".into();
    answer(record, page);
    page.paragraph(
        "Every implementation advances the same oscillators by symplectic Euler, and all of them give \
         the same bits. What sets them apart is how often they go to the memory, and whether the \
         processor finds something to do while it waits for an operation.",
    );
    page.figure(figures::scaling(record)?.number("9.7"));
    page.figure(figures::heat(record)?.number("9.8"));
    page.heading("What limits a step");
    page.paragraph(
        "A step of a lone trajectory takes as long as its longest chain of operations that wait for each \
         other. The program finds that chain by running the shipped step on a number that takes note of \
         what is done to it, and times chains of multiplications and additions in the same run.",
    );
    page.table(record.table("a lone trajectory")?, 3);
    page.paragraph(
        "Where a block of trajectories is in registers, one lane’s waiting is the work of another, and \
         the limit is how many operations the processor starts in a cycle. Beside the fused steps \
         stands a loop of independent multiplications and additions in the proportion of the method, \
         the fastest of several widths.",
    );
    page.table(record.table("fused steps")?, 3);
    page.table(record.table("threads")?, 3);
    page.heading("Memory");
    page.figure(figures::roofline(record)?);
    page.paragraph(
        "Bandwidths count the bytes that the program reads and writes. A plain store also makes the \
         processor read the line that it overwrites, which a stream past the caches does not.",
    );
    page.table(record.table("bandwidth")?, 3);
    page.table(record.table("one step a pass")?, 3);
    page.paragraph(
        "The source estimates bandwidth as four times the size of a float for each step (formula 5.6). \
         That is what a step needs, not what array operations move: each of the five goes through the \
         memory by itself, and together they access twelve arrays.",
    );
    page.table(record.table("bytes of a step")?, 3);
    page.paragraph(
        "Memory that was never written costs a fault for every page: the system finds it, clears it and \
         maps it. That, and not a collector of garbage, is what a new array for every result costs.",
    );
    page.table(record.table("page faults")?, 3);
    page.heading("Regimes");
    page.paragraph(
        "Read off the curves: where steps a second grow faster than √N, a pass costs the same whatever \
         it holds; beyond, rates within a factor of 1.3 make one plateau, which is named by the smallest \
         cache that holds its arrays.",
    );
    page.table(record.table("regimes")?, 3);
    page.heading("The machine");
    page.table(record.table("machine")?, 4);
    noise(record, page);
    Ok(())
}

/// What the fastest implementation reaches, and against what.
fn answer(record: &Record, page: &mut Page) {
    let value = |id: &str| record.finding(id).ok().map(|f| f.measured);
    let share = value("throughput.symplectic-euler.f32");
    let mut sentences = Vec::new();
    if let Some(fused) = value("throughput.best.fused") {
        let rate = format!("{}·10⁹", number(fused / 1e9, 3));
        let of = share.map_or(String::new(), |share| {
            format!(", {} % of what independent arithmetic amounts to", number(100.0 * share, 3))
        });
        sentences
            .push(format!("One core takes {rate} steps of symplectic Euler a second in f32{of}."));
        page.highlights
            .push(Highlight { value: rate, text: "steps a second on one core, f32".into() });
    }
    if let Some(gain) = value("throughput.threads.gain") {
        sentences.push(format!("All cores take {} times as many.", number(gain, 3)));
    }
    if let Some(gain) = value("throughput.fused-over-in-place.f32.1e5") {
        sentences.push(format!(
            "That is {} times what array operations reach for 10⁵ trajectories on the same core: they \
             are bound by their own traffic, not by the problem.",
            number(gain, 2)
        ));
    }
    page.answer = sentences.join(" ");
}

/// Says which ratios could not be judged.
fn noise(record: &Record, page: &mut Page) {
    let noisy = record
        .findings
        .iter()
        .filter(|f| f.verdict == Verdict::Measured && f.text.contains(super::desk::TOO_NOISY));
    match noisy.count() {
        0 => page.paragraph(
            "Every ratio is the median of ratios of neighbouring turns; its tolerance is the distance \
             between their quartiles. The machine was quiet enough to judge all of them.",
        ),
        count => page.note(format!(
            "The machine had other work: for {count} of the ratios the quartiles of the rounds lay too \
             far apart for a verdict. Run the chapter again on a quiet machine."
        )),
    }
}

/// The implementations of which the record holds curves, in their order.
pub(super) fn shown(record: &Record) -> impl Iterator<Item = Implementation> {
    Implementation::ALL.into_iter().filter(|one| {
        record.series.iter().any(|s| s.name.starts_with(&format!("scaling-{}-", one.name())))
    })
}
