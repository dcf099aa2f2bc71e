//! The chapter on efficiency.

use libration::Method;

use crate::figure::{Axis, Figure, Mark, Panel};
use crate::notation::number;
use crate::page::{Highlight, Page};
use crate::record::{Cell, Record, RecordError, Series};
use crate::studies::ink::ink;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Efficiency".into();
    answer(record, page)?;
    page.paragraph(
        "A step is the wrong unit of work: a method with four force evaluations may take steps four \
         times as large, or forty. The figures have the work for one period of the oscillator on one \
         axis and the error of the same run on the other; the circles bound what any phase of the \
         orbit can show, by the eigenvalues and the conserved form of the shipped step.",
    );
    page.figure(precision(record)?.number("9.6"));
    page.paragraph(
        "Read from left to right, a line that lies lower gives more accuracy for the same work. The \
         order of a method is its slope. For the energy a symplectic method needs the same work for a \
         period or for a million; RK4 and explicit Euler pay for the horizon.",
    );
    page.table(record.table("answers")?, 4);
    page.heading("What a step costs");
    page.paragraph(
        "Force evaluations are counted in a run and follow from the tableau, which is read off the \
         step itself. Times are those of a single trajectory, step after step, and belong to this \
         machine.",
    );
    page.table(record.table("cost of a step")?, 3);
    Ok(())
}

/// The answers in words, for the middle tolerance over the longest time.
fn answer(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    let rows = &record.table("answers")?.rows;
    let text = |cell: &Cell| match cell {
        Cell::Text(text) => text.clone(),
        Cell::Number(x) => number(*x, 3),
    };
    let tolerances: Vec<String> = {
        let mut all: Vec<String> = rows.iter().map(|row| text(&row[1])).collect();
        all.dedup();
        let mut seen = Vec::new();
        all.into_iter().for_each(|t| {
            if !seen.contains(&t) {
                seen.push(t)
            }
        });
        seen
    };
    let Some(middle) = tolerances.get(tolerances.len() / 2) else { return Ok(()) };
    let chosen = |kind: &str| rows.iter().rfind(|r| text(&r[0]) == kind && &text(&r[1]) == middle);
    let sentence = |row: &Vec<Cell>| {
        let other = match text(&row[7]).as_str() {
            "—" => "; no other method that was tried gets there".to_owned(),
            name => format!("; {name} would need {}", text(&row[8])),
        };
        format!(
            "For an error of {} in {} over {} periods take {} at ωΔt = {}: {} force evaluations a \
             period{other}.",
            text(&row[1]),
            text(&row[0]),
            text(&row[2]),
            text(&row[3]),
            text(&row[4]),
            text(&row[5]),
        )
    };
    let sentences: Vec<String> =
        ["energy", "state"].iter().filter_map(|kind| chosen(kind)).map(sentence).collect();
    page.answer = sentences.join(" ");
    if let Some(row) = chosen("energy") {
        page.highlights.push(Highlight {
            value: text(&row[3]),
            text: format!(
                "{} an energy error of {} over {} periods",
                if text(&row[7]) == "—" { "alone gets to" } else { "is cheapest for" },
                text(&row[1]),
                text(&row[2])
            ),
        });
    }
    Ok(())
}

/// The methods of which the record holds work–precision series.
fn series(record: &Record) -> impl Iterator<Item = (Method, &Series)> {
    Method::ALL
        .into_iter()
        .filter_map(|m| Some((m, record.series(&format!("work-{}", m.name())).ok()?)))
}

/// Errors against work, a panel for each kind.
fn precision(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("fig-9-6", "Work and precision, from one run each")
        .caption(
            "Lines: simulated. Circles: bounds over all phases of the orbit. The line that lies lowest \
             at an error is the cheapest way to it; that of a method whose error grows with the run \
             would lie higher after a longer one.",
        )
        .description("Log-log: error in energy, phase and state against force evaluations a period.")
        .columns(2)
        .aspect(1.2);
    for (title, column, axis) in [
        ("Energy", "energy", Axis::log("largest energy drift")),
        ("Phase", "phase", Axis::log("largest phase error").unit("rad")),
        ("State", "state", Axis::log("largest error / amplitude")),
        ("Energy, against time", "energy", Axis::log("largest energy drift")),
    ] {
        let by_time = title.ends_with("time");
        let (x, label) = match by_time {
            true => ("time_per_period", Axis::log("time a period").unit("ns")),
            false => ("force_evaluations_per_period", Axis::log("force evaluations a period")),
        };
        let mut panel = Panel::new(label, axis).title(title);
        for (method, series) in series(record) {
            let x = series.column(x)?;
            let measured = shown(series.column(column)?);
            panel = panel.mark(Mark::line(x, measured).ink(ink(method)).label(method.title()));
            if !by_time {
                let bound = shown(series.column(&format!("{column}_bound"))?);
                let every = |v: &[f64]| -> Vec<f64> { v.iter().step_by(2).copied().collect() };
                panel = panel.mark(Mark::prediction(every(x), every(&bound)));
            }
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// What is worth showing: below rounding there is nothing, and beyond a hundredfold no use.
fn shown(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&y| if (1e-15..1e2).contains(&y) { y } else { f64::NAN }).collect()
}
