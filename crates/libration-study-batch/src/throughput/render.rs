//! The chapter on throughput.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Finding, Record, RecordError, Undecided, Verdict};

use super::figures;
use crate::bench::Implementation;

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
    let missing = record.table("not timed")?;
    if !missing.rows.is_empty() {
        page.paragraph("What was asked for and not timed:");
        page.table(missing, 3);
    }
    if let Ok(peers) = record.table("peers") {
        page.heading("Peers");
        page.paragraph(
            "The same oscillators, float and number of steps in NumPy, in place on one core as NumPy is, and \
             in numba, in parallel and with a block of particles in the cache for all steps; by \
             `benches/peers.py`, each in turn. The last column is what the arithmetic of this machine would \
             reach.",
        );
        page.table(peers, 3);
    }
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
    page.paragraph(
        "Clocks, delays and controllers run in the same lanes. Random numbers are drawn by address once for 256 \
         steps and follow from each other in between, so that a trajectory’s noise depends on its number, \
         the step and the seed alone. How many times as long a step takes as one with a fixed clock:",
    );
    page.table(record.table("clocks and delays")?, 3);
    page.heading("Memory");
    page.figure(figures::roofline(record)?);
    page.paragraph(
        "Bandwidths count the bytes that the program reads and writes. A plain store also makes the \
         processor read the line that it overwrites, which a stream past the caches does not; whether \
         that is faster differs between processors.",
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
        "Read off the curves: where more trajectories reach twice the rate, a pass costs about the same \
         whatever it holds; beyond, rates within a factor of 1.3 make one plateau. Passes that move no more \
         than 1.2 times the bytes of the loops over memory are bound by it; others are named by the \
         smallest cache that holds their arrays.",
    );
    page.table(record.table("regimes")?, 3);
    page.heading("The machine");
    page.table(record.table("machine")?, 4);
    noise(record, page);
    Ok(())
}

/// What fused steps reach, and against what: numbers of one table each.
fn answer(record: &Record, page: &mut Page) {
    let value = |id: &str| record.finding(id).ok().map(|f| f.measured);
    let mut sentences = Vec::new();
    if let Some([fused, share, spread]) = fused(record) {
        let rate = format!("{}·10⁹", number(fused, 3));
        // What is more than all, or noise, is no share.
        let of = match share <= 1.0 + spread && spread < 0.1 {
            true => format!(
                ", {} % of what independent arithmetic amounts to",
                number(100.0 * share, 3)
            ),
            false => String::new(),
        };
        sentences
            .push(format!("One core takes {rate} steps of symplectic Euler a second in f32{of}."));
        page.highlights
            .push(Highlight { value: rate, text: "steps a second on one core, f32".into() });
    }
    if let Some(gain) = value("throughput.fused-over-in-place.f32.1e5") {
        sentences.push(format!(
            "For 10⁵ trajectories that is {} times what array operations reach on the same core: they are \
             bound by their own passes, not by the problem.",
            number(gain, 2)
        ));
    }
    if let Some(gain) = value("throughput.threads.gain") {
        sentences.push(format!("All cores take {} times as many as one.", number(gain, 3)));
    }
    page.answer = sentences.join(" ");
}

/// Of symplectic Euler in f32: 10⁹ steps a second, their share of independent arithmetic, and how far
/// the quartiles of that lie apart.
fn fused(record: &Record) -> Option<[f64; 3]> {
    let rows = &record.table("fused steps").ok()?.rows;
    let row =
        rows.iter().find(|row| row[0] == "symplectic Euler".into() && row[1] == "f32".into())?;
    Some([row[3].value()?, row[5].value()?, row[6].value()?])
}

/// Says what was judged, and what the machine was too noisy for.
fn noise(record: &Record, page: &mut Page) {
    let speeds = || record.findings.iter().filter(|f| f.unit == "1" && !f.id.contains("faults"));
    let judged = speeds().filter(|f| f.verdict != Verdict::Measured).count();
    let noisy = |f: &&Finding| matches!(f.undecided, Some(Undecided::Noisy(_)));
    let noisy = speeds().filter(noisy).count();
    page.paragraph(
        "Ratios that are judged are medians of ratios of neighbouring turns; their tolerance is \
         twice the standard error of that median. Where an instruction set has few registers, and in a build \
         with debug assertions, nothing is judged.",
    );
    if noisy > 0 {
        page.note(format!(
            "The machine had other work: of {} ratios that could be judged, the quartiles of {noisy} lay \
             too far apart for a verdict. Run the chapter again on a quiet machine.",
            judged + noisy
        ));
    }
}

/// The implementations of which the record holds curves, in their order.
pub(super) fn shown(record: &Record) -> impl Iterator<Item = Implementation> {
    Implementation::ALL.into_iter().filter(|one| {
        record.series.iter().any(|s| s.name.starts_with(&format!("scaling-{}-", one.name())))
    })
}
