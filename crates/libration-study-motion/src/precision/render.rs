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
        "Each step is taken twice from the same state, in the float type and in a much wider one. The \
         difference of the energies is the rounding error of the step, without the error of the method. \
         The sum of n independent rounding errors is √n times their scatter (Brouwer 1937): this is the prediction. \
         The measured quantity is the invariant of velocity Verlet, ½(v² + ω²(1 − z²/4)x²), in which the \
         method has no error.",
    );
    page.figure(figures::types(record)?);
    page.figure(figures::bits(record)?);
    page.paragraph(
        "A float type has finitely many states, so every orbit ends in a cycle, and the drift \
         stops there. This happens after about as many steps as the significand has values, so \
         earlier with fewer bits. `u` is the unit roundoff. The entry `closes` in place of a \
         predicted drift means that orbits close within the run, or that rounding errors are not \
         independent: between neighbouring steps for z² < 16u, and between turns with few steps.",
    );
    page.table(record.table("float types")?, 3);
    page.heading("Biased rounding of the textbook form");
    page.paragraph(
        "The table compares two forms of one method that are equal in exact arithmetic. The rounding errors of \
         single steps of the textbook form have a significant mean. This bias depends on the time step and on the \
         amplitude, since the grid of floats changes at each power of two.",
    );
    page.figure(figures::forms(record)?);
    page.table(record.table("two forms")?, 3);
    page.heading("Rounding and truncation");
    page.paragraph(
        "Single precision is as accurate as double while its rounding error is below the error of the method. \
         For velocity Verlet this holds up to a number of steps proportional to Δt⁴: with a smaller time step \
         the method is more accurate, and rounding dominates earlier.",
    );
    page.table(record.table("rounding overtakes truncation")?, 3);
    page.table(record.table("single and double precision")?, 4);
    page.note(
        "The phase error of a run in f32 comes from its rounded time step: a relative error ε \
         of the step is a relative error ε of the phase.",
    );
    page.heading("State, force and clock");
    page.paragraph(
        "State, force and clock need different precision. The error of a force in f32 is a small \
         part of that of a state in f32, since a step multiplies the force by Δt. A clock in f32 \
         that sums its steps is soon late by seconds; a clock that multiplies a step counter by Δt \
         avoids this error at no cost.",
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
            "Energy drift from rounding after the whole run: {}. It grows as √n for velocity \
             Verlet and as n for its textbook form, until the orbit closes.",
            drifts.join(", ")
        );
    }
    let clock = record.table("clocks")?.rows.iter().rfind(|row| row[1] == "f32".into());
    if clock.is_some() {
        page.action(
            "Compute the time in f32 as the number of the step times Δt, and do not sum time steps.",
        );
    }
    if let (Some(plain), Some(kept)) = (last("f32"), last("f32-compensated")) {
        if kept < plain {
            page.action(format!(
                "Sum the state in f32 with compensation: its drift falls from {} to {}.",
                number(plain, 2),
                number(kept, 2)
            ));
        }
        page.highlights.push(Highlight {
            value: format!("{} times", number(plain / kept, 2)),
            text: "less drift in f32 with compensated sums".into(),
        });
    }
    if let Some(row) = clock {
        page.highlights.push(Highlight {
            value: format!("{} s", row[5].typeset(3)),
            text: format!("delay of an f32 clock that sums steps, after {} s", row[2].typeset(3)),
        });
    }
    page.action(
        "Measure which float type suffices for your system: `libration lab --system FILE precision`.",
    );
    Ok(())
}
