//! The chapter on efficiency.

use libration::Method;
use libration_report::figure::{Axis, Figure, Mark, Panel, Role};
use libration_report::notation::list;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Cell, Record, RecordError, Series};

use super::actions;
use crate::method_color::method_color;
use crate::subject::Symmetry;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Efficiency".into();
    answer(record, page)?;
    page.paragraph(
        "Work is counted in force evaluations, not in steps, since methods differ in the evaluations per step. \
         The figures show the error of a run against the work for one period of the oscillator. The circles \
         are bounds over all phases of the orbit, from the eigenvalues and the conserved form of the \
         shipped step.",
    );
    page.figure(precision(record)?.number("9.6"));
    let methods: Vec<Method> = series(record).map(|(method, _)| method).collect();
    page.paragraph(format!(
        "A lower line has a smaller error for the same work. Its slope is the order of the \
         error.{}",
        who_pays(&methods)
    ));
    page.table(record.table("answers")?, 4);
    page.heading("Cost of a step");
    page.paragraph(
        "Force evaluations are counted in a run and agree with the tableau of the method. \
         Times are those of a single trajectory on this \
         machine.",
    );
    page.table(record.table("cost of a step")?, 3);
    Ok(())
}

/// Returns a sentence about the methods whose work for an energy tolerance depends on the horizon.
fn who_pays(methods: &[Method]) -> String {
    let (keep, pay): (Vec<Method>, Vec<Method>) =
        methods.iter().partition(|m| Symmetry::of_method(**m).0);
    let titles = |methods: &[Method]| list(&methods.iter().map(|m| m.title()).collect::<Vec<_>>());
    let free = match keep.is_empty() {
        true => "",
        false => {
            " For a given energy error the work per period of symplectic methods is independent of the horizon."
        }
    };
    match pay.as_slice() {
        [] => free.into(),
        pay => format!("{free} The work of {} grows with the horizon.", titles(pay)),
    }
}

/// The answers in words, for the middle tolerance over the longest time.
fn answer(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    let rows = &record.table("answers")?.rows;
    let text = |cell: &Cell| cell.typeset(3);
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
            "—" => "; no other method in this run reaches this error".to_owned(),
            name => format!("; {name} needs {}", text(&row[8])),
        };
        format!(
            "Cheapest method for an error of {} in {} over {} periods: {} at ωΔt = {}, with {} force evaluations per \
             period{other}.",
            text(&row[1]),
            text(&row[0]),
            text(&row[2]),
            text(&row[3]),
            text(&row[4]),
            text(&row[5]),
        )
    };
    actions::add(record.table("answers")?, middle, page);
    let sentences: Vec<String> =
        ["energy", "state"].iter().filter_map(|kind| chosen(kind)).map(sentence).collect();
    page.answer = sentences.join(" ");
    if let Some(row) = chosen("energy") {
        page.highlights.push(Highlight {
            value: text(&row[3]),
            text: format!(
                "{} an energy error of {} over {} periods",
                if text(&row[7]) == "—" { "alone reaches" } else { "is cheapest for" },
                text(&row[1]),
                text(&row[2])
            ),
        });
    }
    Ok(())
}

/// The methods of which the record holds work–precision series.
fn series(record: &Record) -> impl Iterator<Item = (Method, &Series)> {
    Method::all().filter_map(|m| Some((m, record.series(&format!("work-{}", m.name())).ok()?)))
}

/// Errors against work, a panel for each kind.
fn precision(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("fig-9-6", "Work and precision, from one run each")
        .caption(format!(
            "Lines: simulated. Circles: bounds over all phases of the orbit.{}",
            for_a_percent(record)?
        ))
        .description(
            "Log-log: error in energy, phase and state against force evaluations per period.",
        )
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
            true => ("time_per_period", Axis::log("time per period").unit("ns")),
            false => ("force_evaluations_per_period", Axis::log("force evaluations per period")),
        };
        let mut panel = Panel::new(label, axis).title(title);
        let mut accents = (3..).map(Role::Accent);
        for (method, series) in series(record) {
            let role = match method {
                Method::Splitting(_) => accents.next().unwrap_or(Role::Neutral),
                _ => method_color(method),
            };
            let x = series.column(x)?;
            let measured = shown(series.column(column)?);
            panel = panel.mark(Mark::line(x, measured).role(role).label(method.title()));
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

/// Who reaches an error of a percent with the least work in these runs, and who does not at all.
fn for_a_percent(record: &Record) -> Result<String, RecordError> {
    let mut least = Vec::new();
    let mut never = Vec::new();
    for column in ["energy", "phase", "state"] {
        let mut best: Option<(Method, f64)> = None;
        for (method, series) in series(record) {
            let work = series.column("force_evaluations_per_period")?;
            let pairs = || work.iter().zip(series.column(column).unwrap_or_default());
            let enough = pairs().filter(|(_, error)| **error <= 0.01).map(|(&work, _)| work);
            match enough.reduce(f64::min) {
                Some(work) if best.is_none_or(|(_, least)| work < least) => {
                    best = Some((method, work));
                }
                None if column == "state" => never.push(method.title()),
                _ => {}
            }
        }
        least.extend(best.map(|(method, _)| format!("{} in {column}", method.title())));
    }
    let least: Vec<&str> = least.iter().map(String::as_str).collect();
    let mut words = match least.as_slice() {
        [] => String::new(),
        least => format!(" Methods with the least work for an error of 1 %: {}.", list(least)),
    };
    if !never.is_empty() {
        words +=
            &format!(" No step in the figure reaches this error in state with {}.", list(&never));
    }
    Ok(words)
}

/// Returns values above rounding and below a hundred, and NaN elsewhere.
fn shown(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&y| if (1e-15..1e2).contains(&y) { y } else { f64::NAN }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_caption_names_who_was_cheapest_and_who_never_arrived() {
        let mut record = Record::new("efficiency", "?");
        let work = vec![8.0, 16.0, 32.0];
        for (method, errors) in [
            (Method::Leapfrog, vec![0.1, 0.005, 0.001]),
            (Method::ExplicitEuler, vec![9.0, 3.0, f64::NAN]),
        ] {
            let mut series = Series::new(format!("work-{}", method.name())).with(
                "force_evaluations_per_period",
                "1",
                work.clone(),
            );
            for column in ["energy", "phase", "state"] {
                series = series.with(column, "1", errors.clone());
            }
            record.series.push(series);
        }
        let caption = for_a_percent(&record).unwrap_or_default();
        assert!(caption.contains("leapfrog in energy, leapfrog in phase and leapfrog in state"));
        assert!(
            caption.ends_with(
                "No step in the figure reaches this error in state with explicit Euler."
            )
        );
        assert!(!who_pays(&[Method::Leapfrog]).contains("RK4"));
        assert!(who_pays(&[Method::Leapfrog, Method::Rk4]).contains("The work of RK4 grows"));
    }
}
