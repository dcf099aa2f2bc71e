//! The chapter on throughput.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Agreement, Finding, Record, RecordError, Undecided};

use super::figures;
use crate::bench::Implementation;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Throughput".into();
    answer(record, page);
    page.paragraph(
        "Every implementation advances the same oscillators by symplectic Euler, with \
         the same bits. The implementations differ in the number of memory accesses, and in the independent \
         operations that the processor can execute at the same time.",
    );
    page.figure(figures::scaling(record)?.number("9.7"));
    page.figure(figures::heat(record)?.number("9.8"));
    let missing = record.table("not timed")?;
    if !missing.rows.is_empty() {
        page.paragraph("Not measured:");
        page.table(missing, 3);
    }
    if let Ok(peers) = record.table("peers") {
        page.heading("Peers");
        page.paragraph(
            "The same oscillators, float type and number of steps in NumPy, in place on one core, and \
             in numba, in parallel and with a block of particles in the cache for all steps. \
             `benches/peers.py` measures them alternately. The last column is the limit by the arithmetic of this \
             machine.",
        );
        page.table(peers, 3);
    }
    page.heading("Limits of a step");
    page.paragraph(
        "A step of a single trajectory takes the time of its longest chain of dependent \
         operations. The program finds this chain by running the shipped step on a number type that records \
         operations, and measures chains of multiplications and additions in the same run.",
    );
    page.table(record.table("a lone trajectory")?, 3);
    page.paragraph(
        "With a block of trajectories in registers, the lanes are independent, and the limit is \
         the number of operations that the processor starts per cycle. The reference of the fused \
         steps is a loop of independent multiplications and additions, in the same ratio as in the \
         method; of several block widths the fastest counts.",
    );
    page.table(record.table("fused steps")?, 3);
    page.table(record.table("threads")?, 3);
    page.paragraph(
        "Clocks, delays and controllers run in the same lanes. Every 256 steps a counter-based \
         generator seeds a sequential generator, which draws the numbers in between. The noise of \
         a trajectory depends only on its number, the step and the seed. Time of a step relative \
         to one with a fixed clock:",
    );
    page.table(record.table("clocks and delays")?, 3);
    page.heading("Memory");
    page.figure(figures::roofline(record)?);
    page.paragraph(
        "Bandwidths count the bytes that the program reads and writes. A plain store also makes \
         the processor read the cache line that it overwrites. A non-temporal store, past the \
         caches, does not; whether it is faster depends on the processor.",
    );
    page.table(record.table("bandwidth")?, 3);
    page.table(record.table("one step a pass")?, 3);
    page.paragraph(
        "The source estimates bandwidth as four times the size of a float per step (formula 5.6). \
         That is the minimum of a step. Array operations move more: each of the five passes through the \
         memory separately, and together they access twelve arrays.",
    );
    page.table(record.table("bytes of a step")?, 3);
    page.paragraph(
        "New memory causes a fault for every page: the system finds a page, clears it and \
         maps it. This is the cost of a new array for every result, not garbage collection.",
    );
    page.table(record.table("page faults")?, 3);
    page.heading("Regimes");
    page.paragraph(
        "The regimes follow from the measured curves. If more trajectories reach twice the rate, fixed costs of a pass \
         dominate. Beyond that, rates within a factor of 1.3 form a plateau. A plateau is limited by memory if its \
         passes move at most 1.2 times the bytes per second of the memory loops; other plateaus have the name of the \
         smallest cache that holds their arrays.",
    );
    page.table(record.table("regimes")?, 3);
    page.heading("The machine");
    page.table(record.table("machine")?, 4);
    noise(record, page);
    actions(record, page);
    Ok(())
}

/// The speed of fused steps and of their references: numbers of one table each.
fn answer(record: &Record, page: &mut Page) {
    let value = |id: &str| record.finding(id).ok().map(|f| f.measured);
    let mut sentences = Vec::new();
    if let Some([fused, share, spread]) = fused(record) {
        let rate = format!("{}·10⁹", number(fused, 3));
        // What is more than all, or noise, is no share.
        let of = match share <= 1.0 + spread && spread < 0.1 {
            true => {
                format!(", {} % of the rate of independent arithmetic", number(100.0 * share, 3))
            }
            false => String::new(),
        };
        sentences
            .push(format!("One core: {rate} steps of symplectic Euler per second in f32{of}."));
        page.highlights
            .push(Highlight { value: rate, text: "steps per second on one core, f32".into() });
    }
    if let Some(gain) = value("throughput.fused-over-in-place.f32.1e5") {
        sentences.push(format!(
            "For 10⁵ trajectories this is {} times the rate of array operations on the same core, which are \
             limited by their passes through memory.",
            number(gain, 2)
        ));
    }
    if let Some(gain) = value("throughput.threads.gain") {
        sentences.push(format!("All cores reach {} times the rate of one.", number(gain, 3)));
    }
    page.answer = sentences.join(" ");
}

/// How to use the speed of the machine.
fn actions(record: &Record, page: &mut Page) {
    let value = |id: &str| record.finding(id).ok().map(|f| f.measured);
    page.action(
        "Measure the rate of your number of trajectories: `libration bench --implementation fused --num-trajectories 1e4`.",
    );
    if value("throughput.fused-over-in-place.f32.1e5").is_some_and(|gain| gain > 1.0) {
        page.action(
            "Take all steps of a block of trajectories before the next block, not one step of all in turn.",
        );
    }
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
    let judged = speeds().filter(|f| f.verdict != Agreement::Measured).count();
    let noisy = |f: &&Finding| matches!(f.undecided, Some(Undecided::Noisy(_)));
    let noisy = speeds().filter(noisy).count();
    page.paragraph(
        "Ratios with a criterion are medians of ratios of neighbouring rounds; their tolerance is \
         twice the standard error of that median. There is no verdict for instruction sets with few registers, or in a build \
         with debug assertions.",
    );
    if noisy > 0 {
        page.note(format!(
            "The machine was busy: of {} ratios with a criterion, the quartiles of {noisy} are \
             too far apart for a verdict. Repeat the study on an idle machine.",
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
