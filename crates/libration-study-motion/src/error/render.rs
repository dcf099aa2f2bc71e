//! The chapter on errors.

use libration::Method;
use libration_report::figure::{Axis, Dash, Envelope, Figure, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use crate::method_color::method_color;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Error growth".into();
    let is_the_sources = record.claims.iter().any(|claim| claim.id == "C75");
    summary(record, page, is_the_sources);
    page.paragraph(
        "On the oscillator the numerical and the exact orbit are sums of powers of eigenvalues. The mean \
         square of their difference over any number of steps is therefore a geometric series. The circles \
         are its sum, with 1024 bits; the lines are simulated errors relative to an exact solution in \
         double-double.",
    );
    page.figure(running(record)?.number("9.3"));
    page.table(record.table("errors")?, 6);
    if is_the_sources {
        page.paragraph(
            "A million steps of 1 ms reproduce the first three numbers of the source to the last digit, as root \
             mean squares over a million instants from the start, if the state after a step is compared with the \
             solution before it. This time shift alone gives z/√2 = 0.00224, four fifths of the error that the source \
             reports for Verlet. Compared at equal times, the error of each method agrees with its phase \
             error.",
        );
    }
    if let Ok(suspects) = record.table("suspects")
        && is_the_sources
    {
        page.heading("The RK4 of the source");
        page.paragraph(
            "The source reports 0.90339 for RK4, four hundred times the error of a correct RK4 in the \
             same comparison. If one stage of RK4 adds an acceleration times Δt to the position in place of \
             Δt², the frequency is wrong by ⅚Δt and the final phase error is 2.6 rad. The error of this \
             variant is within 1/300 of the number of the source; no other variant in the table is. \
             No variant reproduces all five digits, so the mistake of the source remains unknown.",
        );
        page.table(suspects, 6);
    }
    page.figure(steps(record)?);
    if record.series("growth").is_ok() {
        page.figure(growth(record)?.number("9.4"));
    }
    actions(record, page);
    Ok(())
}

fn summary(record: &Record, page: &mut Page, is_the_sources: bool) {
    let error = |m: Method, kind: &str| {
        record.finding(&format!("error.{}.{kind}", m.name())).ok().map(|f| f.measured)
    };
    let sizes: Vec<String> = Method::ALL
        .into_iter()
        .filter_map(|m| Some(format!("{} {} m", m.title(), number(error(m, "aligned")?, 3))))
        .collect();
    page.answer = format!("Root mean square error in position: {}.", sizes.join(", "));
    if !is_the_sources {
        return;
    }
    if let (Some(verlet), Some(late)) =
        (error(Method::VelocityVerlet, "aligned"), error(Method::VelocityVerlet, "late"))
    {
        page.highlights.push(Highlight {
            value: format!("{} %", number(100.0 * (1.0 - verlet / late), 2)),
            text: "of the error of Verlet in the source is due to a time shift of one step".into(),
        });
    }
    if let (Some(verlet), Some(rk4)) =
        (error(Method::VelocityVerlet, "aligned"), error(Method::Rk4, "aligned"))
    {
        page.headline = format!(
            "RMS error in position: RK4 {} m, velocity Verlet {} m. The source reports the opposite \
             order.",
            number(rk4, 2),
            number(verlet, 2)
        );
    }
}

/// What a comparison at wrong times costs, and the step of the reader's system for an error.
fn actions(record: &Record, page: &mut Page) {
    let error = |m: Method, kind: &str| {
        record.finding(&format!("error.{}.{kind}", m.name())).ok().map(|f| f.measured)
    };
    let pairs = Method::ALL
        .into_iter()
        .filter_map(|m| Some((m, [error(m, "aligned")?, error(m, "late")?])));
    let hidden = pairs.filter(|(_, [aligned, late])| *late > 2.0 * aligned);
    if let Some((method, [aligned, late])) =
        hidden.max_by(|a, b| (a.1[1] / a.1[0]).total_cmp(&(b.1[1] / b.1[0])))
    {
        page.action(format!(
            "Compare states with a reference at the same time. A shift of one step turns the error of {} from {} m into {} m.",
            method.title(),
            number(aligned, 2),
            number(late, 2)
        ));
    }
    page.action(
        "Find the time step for an error of your trajectory: `libration advise --system FILE --tolerance trajectory=1e-3 --horizon 10`.",
    );
}

/// The methods of which the record holds series with this prefix, in the order of the catalogue.
fn with_series<'a>(
    record: &'a Record,
    prefix: &'a str,
) -> impl Iterator<Item = (Method, &'a libration_report::record::Series)> {
    Method::ALL
        .into_iter()
        .filter_map(move |m| Some((m, record.series(&format!("{prefix}-{}", m.name())).ok()?)))
}

/// The running errors, as they are and one step late.
fn running(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("fig-9-3", "RMS error in position so far")
        .caption(
            "Left: error relative to the solution at the same time. Right: relative to the solution one \
             step before, as in the source. There the time shift hides the error of accurate \
             methods. Lines: simulated. Circles: the geometric series.",
        )
        .description("Log-log: running root mean square error of each method against time.")
        .columns(2)
        .aspect(1.15);
    for (title, column) in [("At the same time", "aligned"), ("One step late", "late")] {
        let mut panel = Panel::new(Axis::log("time t").unit("s"), Axis::log("RMS error").unit("m"))
            .title(title);
        for (method, series) in with_series(record, "running") {
            let (t, measured) = (series.column("t")?, series.column(column)?);
            let predicted = series.column(&format!("{column}_predicted"))?;
            let every =
                |values: &[f64]| -> Vec<f64> { values.iter().rev().step_by(8).copied().collect() };
            panel = panel
                .mark(
                    Mark::line(t, shown(measured)).role(method_color(method)).label(method.title()),
                )
                .mark(Mark::prediction(every(t), every(&shown(predicted))));
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// The error over the same time against the step.
fn steps(record: &Record) -> Result<Figure, RecordError> {
    let mut panel =
        Panel::new(Axis::log("time step Δt").unit("s"), Axis::log("RMS error").unit("m"));
    for (method, series) in with_series(record, "step") {
        let dt = series.column("dt")?;
        panel = panel
            .mark(
                Mark::line(dt, shown(series.column("measured")?))
                    .role(method_color(method))
                    .label(method.title()),
            )
            .mark(Mark::prediction(dt, shown(series.column("predicted")?)));
    }
    Ok(Figure::new("error-step", "RMS error over the same time, for larger steps")
        .caption(
            "An error of order p rises with the p-th power of the step, until the phase error is a whole \
             turn. Beyond that the error grows only if the orbit does. Lines: \
             simulated. Circles: the geometric series.",
        )
        .description("Log-log: error against time step, flat for phase errors above a turn.")
        .panel(panel))
}

/// The errors worth showing: an error below rounding is none, and one beyond a thousand amplitudes has
/// left the figure.
fn shown(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&y| if (1e-16..1e3).contains(&y) { y } else { f64::NAN }).collect()
}

/// The growth of explicit Euler.
fn growth(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("growth")?;
    let column = |name: &str| series.column(name).map(<[f64]>::to_vec);
    let (t, bound) = (column("t")?, column("bound")?);
    let envelope = Envelope { x: t.clone(), low: column("low")?, high: column("high")? };
    let edge =
        |y: Vec<f64>| Mark::line(t.clone(), y).role(Role::Theory).dash(Dash::Solid).width(1.0);
    let below = bound.iter().map(|b| -b).collect();
    let panel = Panel::new(Axis::linear("time t").unit("s"), Axis::linear("x").unit("m"))
        .mark(Mark::envelope(envelope).role(method_color(Method::ExplicitEuler)))
        .mark(edge(bound.clone()))
        .mark(edge(below));
    Ok(Figure::new("fig-9-4", "Explicit Euler: the amplitude grows exponentially")
        .caption(
            "Shaded: lowest to highest position in each part of the run. Lines: ±(1 + z²)ⁿᐟ² times \
             the start, from the determinant.",
        )
        .description("The position of explicit Euler against time, within its exponential bounds.")
        .aspect(2.4)
        .panel(panel))
}
