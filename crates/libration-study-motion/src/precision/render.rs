//! The chapter on precision.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::figures;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Precision".into();
    summary(record, page)?;
    page.paragraph(
        "Each step is taken twice from the same state, in the float type and in a much wider one: the \
         difference of the energies is what the step has rounded, whatever the error of the method. \
         Independent roundings leave √n times their scatter (Brouwer 1937), and that is the prediction. \
         What is measured is what velocity Verlet conserves, ½(v² + ω²(1 − z²/4)x²), in which the \
         method itself has no error.",
    );
    page.figure(figures::types(record)?);
    page.figure(figures::bits(record)?);
    page.paragraph(
        "A float type has finitely many states, so every orbit ends in a cycle, and from there on \
         nothing drifts any more. The fewer bits, the sooner: after about as many steps as the \
         significand has values. `u` is the unit roundoff; where a prediction says `closes`, orbits \
         close within the run, or steps do not round at random: neighbours alike where z² < 16u, whole turns \
         where a turn has few steps.",
    );
    page.table(record.table("float types")?, 3);
    page.heading("A bias");
    page.paragraph(
        "Two forms of one method, equal in exact arithmetic. The bias of the textbook’s form is found in \
         single steps, as a mean that is no accident; it depends on the time step and on the amplitude, \
         since coordinates round on another grid beyond each power of two.",
    );
    page.figure(figures::forms(record)?);
    page.table(record.table("two forms")?, 3);
    page.heading("Rounding and truncation");
    page.paragraph(
        "Single precision is as good as double as long as its rounding is below the error of the method. \
         For velocity Verlet that is a number of steps, which goes as Δt⁴: with a smaller time step the \
         method is more accurate, and its rounding takes over sooner.",
    );
    page.table(record.table("rounding overtakes truncation")?, 3);
    page.table(record.table("single and double precision")?, 4);
    page.note(
        "The phase by which a run in f32 is ahead is that of its time step, which f32 rounds: a part ε \
         of the step is a part ε of the phase.",
    );
    page.heading("State, force and clock");
    page.paragraph(
        "Precision is needed in three places, and not in the same measure. A force in f32 is worth a small \
         part of what a state in f32 costs, since a step adds it in with a factor Δt; and a clock that \
         adds up its steps is the worst place to save: in f32 it soon lags by seconds. A step counter \
         times Δt costs nothing and does not.",
    );
    page.table(record.table("parts")?, 3);
    page.table(record.table("clocks")?, 9);
    Ok(())
}

/// The answer, and what to take away from it.
fn summary(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    let last = |name: &str| -> Option<f64> {
        record.series(&format!("type-{name}")).ok()?.column("drift").ok()?.last().copied()
    };
    let drifts: Vec<String> = ["f16", "f32", "f32-compensated", "f64"]
        .iter()
        .filter_map(|name| Some(format!("{} in {name}", number(last(name)?, 2))))
        .collect();
    if !drifts.is_empty() {
        page.answer = format!(
            "What rounding leaves of an energy after the whole run: {}. It grows like √n for velocity \
             Verlet and like n for its textbook form, until the orbit closes.",
            drifts.join(", ")
        );
    }
    if let (Some(plain), Some(kept)) = (last("f32"), last("f32-compensated")) {
        page.highlights.push(Highlight {
            value: format!("{} times", number(plain / kept, 2)),
            text: "less drift in f32 with compensated sums".into(),
        });
    }
    let clock = record.table("clocks")?.rows.iter().rfind(|row| row[1] == "f32".into());
    if let Some(row) = clock {
        page.highlights.push(Highlight {
            value: format!("{} s", row[5].typeset(3)),
            text: format!("behind is a clock in f32 that adds up {} s", row[2].typeset(3)),
        });
    }
    Ok(())
}
