//! The chapter on orders.

use libration::Method;
use libration_report::figure::{Axis, Dash, Figure, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError, Series};

use super::actions;
use super::asymptotic_range::undecided_methods;
use super::state_orders::table_name;
use crate::method_color::method_color;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page, is_own: bool) -> Result<(), RecordError> {
    page.title = "Order".into();
    let systems = systems(record)?;
    summary(record, page, &systems);
    actions::add(record, &systems, is_own, page);
    page.paragraph(
        "Every method runs in double-double arithmetic, whose rounding is negligible. The time step is halved \
         until the slopes between successive errors settle. The reference is the exact flow to about \
         thirty digits, extrapolated from a midpoint rule that is independent of the methods. \
         Errors are averaged over a whole orbit, because at single points they may be of higher order \
         by accident: at a turning point of a closed orbit a phase error has no effect on the position.",
    );
    page.figure(errors(record, &systems, "global")?);
    page.table(record.table("orders")?, 4);
    page.paragraph(
        "The exponents are least-squares slopes through the five smallest steps of each line. The \
         local error of one step is one order higher than the global error of the orbit, since the \
         number of steps is proportional to 1/Δt.",
    );
    for (name, title) in &systems {
        if let Some(text) = derived_orders(record, name, title) {
            page.paragraph(text);
        }
        if let Ok(table) = record.table(&table_name(name)) {
            page.heading(format!("States of {title}"));
            page.paragraph(
                "Exponents of the error of each state over orbits. None is below the order; in single states the leading term of \
                 the error may vanish.",
            );
            page.table(table, 4);
        }
    }
    page.figure(errors(record, &systems, "local")?);
    if let Ok(trap) = record.series("trap") {
        page.heading("Order from a start without force");
        page.paragraph(
            "Symplectic Euler is of order 1. From a start where the force vanishes, its positions are \
             those of a Verlet orbit that begins half a kick later. The positions alone therefore \
             show order 2; the velocities show order 1.",
        );
        page.figure(trapped(trap)?);
    }
    if let Ok(words) = record.table("words") {
        page.heading("Order conditions of splitting methods");
        page.paragraph(
            "A splitting method is a product of exponentials of kicks K and drifts D, which do not commute. \
             If its expansion agrees with `e^(K + D)` in all words of up to p letters, the order is p on \
             every system; no run is needed. On an oscillator some words vanish. The method `lookalike` \
             fits all other words: its order is 4 on an oscillator and 3 on a pendulum, as the expansion \
             predicts.",
        );
        page.table(words, 3);
    }
    Ok(())
}

/// The orders that methods lose or win on a system, in a sentence.
fn derived_orders(record: &Record, name: &str, title: &str) -> Option<String> {
    let other = |method: Method| {
        let id = format!("convergence.{name}.{}.global-order", method.name());
        let order = record.finding(&id).ok()?.predicted?;
        (order != f64::from(method.order()))
            .then(|| format!("{} {}", method.title(), number(order, 1)))
    };
    let others: Vec<String> = Method::ALL.into_iter().filter_map(other).collect();
    (!others.is_empty()).then(|| {
        format!(
            "Accelerations of {title} depend on velocities. A kick takes them at a velocity from before it, so that methods of kicks \
             and drifts have another order, predicted from one step in 1024 bits: {}.",
            others.join(", ")
        )
    })
}

/// The systems studied: name and title.
fn systems(record: &Record) -> Result<Vec<(String, String)>, RecordError> {
    let rows = &record.table("systems")?.rows;
    Ok(rows.iter().map(|row| (row[0].typeset(6), row[1].typeset(6))).collect())
}

/// The answer: the range of the exponents of each method.
fn summary(record: &Record, page: &mut Page, systems: &[(String, String)]) {
    let range = |method: Method| {
        let order = |(system, _): &(String, String)| {
            let id = format!("convergence.{system}.{}.global-order", method.name());
            record.finding(&id).ok().map(|f| f.measured)
        };
        let orders: Vec<f64> = systems.iter().filter_map(order).collect();
        let low = orders.iter().copied().reduce(f64::min)?;
        let high = orders.iter().copied().reduce(f64::max)?;
        let (low, high) = (format!("{low:.2}"), format!("{high:.2}"));
        Some(if low == high { low } else { format!("{low} to {high}") })
    };
    let found: Vec<(Method, String)> =
        Method::ALL.into_iter().filter_map(|m| Some((m, range(m)?))).collect();
    let shown: Vec<String> = found.iter().map(|(m, r)| format!("{} {r}", m.title())).collect();
    let names: Vec<&str> = systems.iter().map(|(_, title)| title.as_str()).collect();
    if shown.is_empty() {
        return;
    }
    page.answer = format!(
        "Order of the error over an orbit, fitted on {}: {}.",
        names.join("; "),
        shown.join(", ")
    );
    for (system, title) in systems {
        let undecided = undecided_methods(record, system);
        if !undecided.is_empty() {
            page.answer += &format!(
                " Undecided on {title}: {}, whose errors still fall faster than with the order at the smallest steps that were tried.",
                undecided.join(", ")
            );
        }
    }
    let off = record.findings.iter().filter(|f| f.id.ends_with("-order"));
    let distances = off.filter_map(|f| Some((f.measured - f.predicted?).abs()));
    if let Some(worst) = distances.reduce(f64::max) {
        page.highlights.push(Highlight {
            value: number(worst, 2),
            text: "largest difference between a fitted and a predicted order, in phase space"
                .into(),
        });
    }
}

/// Errors against the step, one panel a system, with guide slopes.
fn errors(
    record: &Record,
    systems: &[(String, String)],
    kind: &str,
) -> Result<Figure, RecordError> {
    let (of, rise) = match kind {
        "global" => ("an orbit", "p"),
        _ => ("one step", "p + 1"),
    };
    let mut figure = Figure::new(
        format!("order-{kind}"),
        format!("Error of {of} against the time step"),
    )
    .caption(format!(
        "{} Thin lines: slopes of integer order through the smallest step. Error in phase space, \
         velocities in units of 2π/turn.",
        slopes(record, systems, kind, rise)
    ))
    .description(format!("Log-log: the error of {of} against Δt for each method and system."))
    .columns(if systems.len() > 1 { 2 } else { 1 })
    .aspect(if systems.len() > 1 { 1.25 } else { 1.75 });
    for (name, title) in systems {
        let series = record.series(&format!("{kind}-{name}"))?;
        let order = |method: Method| {
            let id = format!("convergence.{name}.{}.{kind}-order", method.name());
            let predicted = record.finding(&id).ok().and_then(|f| f.predicted);
            // Whole numbers.
            predicted.map(|order| order as i32)
        };
        figure = figure.panel(panel(series, title, order)?);
    }
    Ok(figure)
}

/// A sentence on the fitted orders of the lines: theory promises nothing where forces depend on velocities.
fn slopes(record: &Record, systems: &[(String, String)], kind: &str, rise: &str) -> String {
    let end = format!(".{kind}-order");
    let orders = || record.findings.iter().filter(|f| f.id.ends_with(&end));
    let everywhere = if systems.len() > 1 { ", on every system alike" } else { "" };
    match (orders().any(|f| f.agrees()), orders().all(|f| f.agrees())) {
        (true, true) => format!("Each line falls with the slope {rise} of its method{everywhere}."),
        (true, false) => format!(
            "Lines fall with the slope {rise} of their method where theory promises it and the \
             table confirms it."
        ),
        _ => "No line falls with the predicted slope.".into(),
    }
}

/// The errors of all methods, with guides where an order is predicted.
fn panel(
    series: &Series,
    title: &str,
    order: impl Fn(Method) -> Option<i32>,
) -> Result<Panel, RecordError> {
    let dt = series.column("dt")?;
    let mut panel =
        Panel::new(Axis::log("time step Δt").unit("s"), Axis::log("error")).title(title);
    for method in Method::ALL {
        let Ok(errors) = series.column(&format!("{} together", method.name())) else { continue };
        if let Some(order) = order(method) {
            let guide = guide(dt, errors, order);
            panel =
                panel.mark(Mark::line(dt, guide).role(Role::Theory).dash(Dash::Solid).width(0.8));
        }
        panel = panel.mark(Mark::line(dt, errors).role(method_color(method)).label(method.title()));
    }
    Ok(panel)
}

/// The power `order` of the step through the last error.
fn guide(dt: &[f64], errors: &[f64], order: i32) -> Vec<f64> {
    let last = dt.iter().zip(errors).rfind(|(_, e)| e.is_finite());
    let Some((&at, &error)) = last else { return vec![f64::NAN; dt.len()] };
    let law = |&h: &f64| error * (h / at).powi(order);
    dt.iter().zip(errors).map(|(h, e)| if e.is_finite() { law(h) } else { f64::NAN }).collect()
}

/// Symplectic Euler from the equilibrium.
fn trapped(series: &Series) -> Result<Figure, RecordError> {
    let dt = series.column("dt")?;
    let line = |part: &str, label: &str, accent| -> Result<Mark, RecordError> {
        Ok(Mark::line(dt, series.column(part)?).role(Role::Accent(accent)).label(label))
    };
    let guide = |part: &str, order| -> Result<Mark, RecordError> {
        let guide = guide(dt, series.column(part)?, order);
        Ok(Mark::line(dt, guide).role(Role::Theory).dash(Dash::Solid).width(0.8))
    };
    Ok(Figure::new("order-trap", "Symplectic Euler from a start without force")
        .caption(
            "The error in position falls with the second power of the step, that in velocity with \
             the first. Thin lines: slopes two and one.",
        )
        .description("Log-log: errors of symplectic Euler in position and in velocity against Δt.")
        .panel(
            Panel::new(Axis::log("time step Δt").unit("s"), Axis::log("error (m, m/s)"))
                .mark(guide("position", 2)?)
                .mark(guide("velocity", 1)?)
                .mark(line("position", "position", 0)?)
                .mark(line("velocity", "velocity", 1)?),
        ))
}

#[cfg(test)]
mod tests {
    use libration_report::record::{Finding, Tolerance};

    use super::*;

    #[test]
    fn a_caption_promises_a_slope_only_where_it_was_found() {
        let mut record = Record::new("convergence", "?");
        let systems = [("a".to_owned(), "a".to_owned())];
        let caption = |record: &Record| slopes(record, &systems, "global", "p");
        assert!(caption(&record).starts_with("No line"));
        let tolerance = Tolerance::absolute(0.1, "");
        let id = "convergence.a.rk4.global-order";
        record.find(Finding::predicted(id, "", "1", 4.0, 4.01, tolerance));
        assert_eq!(caption(&record), "Each line falls with the slope p of its method.");
        // A splitting method under friction, of which no order is promised.
        let id = "convergence.a.leapfrog.global-order";
        record.find(Finding::measured(id, "", "1", 1.0));
        assert!(caption(&record).contains("where theory promises it"));
    }

    #[test]
    fn a_guide_passes_through_the_smallest_step_with_its_slope() {
        let drawn = guide(&[0.4, 0.2, 0.1], &[9.0, 5.0, f64::NAN], 2);
        assert_eq!(drawn[..2], [20.0, 5.0]);
        assert!(drawn[2].is_nan());
    }
}
