//! The chapter on nonlinear systems.

use libration::Method;
use libration_report::figure::{Axis, Dash, Figure, Mark, Panel, Role};
use libration_report::notation::{number, seconds};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Column, Record, RecordError};

use super::actions;
use super::captions::{growths, rates, step_of_portraits};
use crate::method_color::method_color;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page, is_own: bool) -> Result<(), RecordError> {
    page.title = if is_own { "Energy" } else { "Nonlinear systems" }.into();
    let systems = systems(record)?;
    summary(record, page, &systems)?;
    page.paragraph(
        "With nonlinear forces no update matrix predicts a million steps. Theory predicts powers of the \
         time step: a symplectic method of order p keeps the energy in a band of width Δt^p, \
         constant in time. With other methods the energy drifts, and the drift grows with the \
         horizon.",
    );
    page.figure(growth(record, &systems)?);
    page.table(record.table("growth")?, 3);
    page.figure(swings(record, &systems)?);
    if let Some(rates) = rates(record) {
        page.paragraph(format!(
            "Within one turn the energy of a method of order p oscillates by Δt^p, if forces are not \
             linear. The change after a whole turn differs: for an even order p the term Δt^p \
             is odd under time reversal, and its contributions to the two halves of a closed orbit \
             cancel. In a turn of a closed orbit the energy therefore drifts by {rates}."
        ));
    }
    let defects = record.table("defects")?;
    if !defects.rows.is_empty() {
        page.heading("One step");
        page.paragraph(
            "Dual numbers of 1024 bits give the Jacobian of each shipped step along the orbit. A defect is \
             either zero to all bits, or a power of Δt; the sizes are those at 256 steps per turn.",
        );
        page.table(defects, 3);
    }
    page.heading("Limits of stability");
    page.paragraph(
        "Close to a stable equilibrium the limit is that of harmonic motion with the highest \
         frequency of the modes, and simulation confirms it. From the configured start there is no prediction: a \
         search scans the time steps upward, and then below the first unstable step with a finer grid and \
         longer runs, since resonances cause narrow unstable ranges.",
    );
    page.table(record.table("limits")?, 4);
    page.figure(portraits(record, &systems)?);
    actions::add(record, is_own, page);
    Ok(())
}

/// The systems studied: name and title.
fn systems(record: &Record) -> Result<Vec<(String, String)>, RecordError> {
    let rows = &record.table("systems")?.rows;
    Ok(rows.iter().map(|row| (row[0].typeset(6), row[1].typeset(6))).collect())
}

/// The answer, from the drifts over the whole horizon.
pub(super) fn summary(
    record: &Record,
    page: &mut Page,
    systems: &[(String, String)],
) -> Result<(), RecordError> {
    let found = |system: &str, method: Method, quantity: &str| {
        let id = format!("nonlinear.{system}.{}.{quantity}", method.name());
        record.finding(&id).ok().map(|f| f.measured)
    };
    let rows = &record.table("growth")?.rows;
    let largest: Vec<String> = systems
        .iter()
        .filter_map(|(_, title)| {
            // A run that left the floats has no size, and says so in the table.
            let of = |m: Method| {
                let row =
                    rows.iter().find(|r| r[0].typeset(6) == *title && r[1].typeset(6) == m.title());
                Some(format!("{} {}", m.title(), row?[2].typeset(2)))
            };
            let all: Vec<String> = Method::ALL.into_iter().filter_map(of).collect();
            (!all.is_empty()).then(|| format!("{title}: {}", all.join(", ")))
        })
        .collect();
    if !largest.is_empty() {
        page.answer = format!(
            "Largest relative energy drift over the whole horizon: {}.",
            largest.join("; ")
        );
    }
    let growths = |keep: fn(&f64) -> bool| {
        let growth = record.findings.iter().filter(|f| f.id.ends_with(".growth"));
        growth.filter(move |f| f.predicted.as_ref().is_some_and(keep)).map(|f| f.measured)
    };
    if let Some(worst) = growths(|&p| p == 0.0).reduce(f64::max) {
        page.highlights.push(Highlight {
            value: format!("t^{{{:.2}}}", worst.max(0.0)),
            text: "fastest growth of the energy drift of a symplectic method".into(),
        });
    }
    let rate = |(name, title): &(String, String)| {
        Some((found(name, Method::Rk4, "rate-order")?, title.clone()))
    };
    if let Some((rate, title)) = systems.iter().find_map(rate) {
        page.highlights.push(Highlight {
            value: format!("Δt^{{{}}}", number(rate, 3)),
            text: format!("mean energy change of RK4 in a turn: {title}"),
        });
    }
    Ok(())
}

/// A figure with a panel for each system.
fn figure(id: &str, title: &str, systems: &[(String, String)]) -> Figure {
    let figure = Figure::new(id, title);
    match systems.len() {
        1 => figure,
        _ => figure.columns(2).aspect(1.25),
    }
}

/// Returns values up to a thousand times the initial energy, and NaN beyond.
fn shown(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&y| if y < 1e3 { y } else { f64::NAN }).collect()
}

/// The running maxima against time.
fn growth(record: &Record, systems: &[(String, String)]) -> Result<Figure, RecordError> {
    let title = "Largest energy drift so far";
    let mut figure = figure("nonlinear-growth", title, systems)
        .caption(growths(record)?)
        .description("Log-log: the running maximum of the energy drift against turns.");
    for (name, title) in systems {
        let series = record.series(&format!("growth-{name}"))?;
        let turns = series.column("turns")?;
        let mut panel =
            Panel::new(Axis::log("turns"), Axis::log("largest |E − E₀|/|E₀|")).title(title);
        for method in Method::ALL {
            let Ok(largest) = series.column(method.name()) else { continue };
            let line = Mark::line(turns, shown(largest));
            panel = panel.mark(line.role(method_color(method)).label(method.title()));
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// The swing within a turn and the mean change of a turn against the step.
fn swings(record: &Record, systems: &[(String, String)]) -> Result<Figure, RecordError> {
    let title = "Energy drift against the time step";
    let mut figure = figure("nonlinear-swing", title, systems)
        .caption(match record.series.iter().any(|series| series.name.starts_with("rate-")) {
            true => {
                "Lines: the largest drift within a turn. Crosses: the mean change in a turn, for \
                 methods that are not symplectic."
            }
            false => "Lines: the largest drift within a turn.",
        })
        .description("Log-log: energy drift within a turn against Δt, one line a method.");
    for (name, title) in systems {
        let mut panel = Panel::new(Axis::log("time step Δt").unit("s"), Axis::log("|E − E₀|/|E₀|"))
            .title(title);
        for method in Method::ALL {
            let name = format!("{name}-{}", method.name());
            let Ok(swing) = record.series(&format!("swing-{name}")) else { continue };
            let line = Mark::line(swing.column("dt")?, shown(swing.column("swing")?));
            panel = panel.mark(line.role(method_color(method)).label(method.title()));
            let Ok(rate) = record.series(&format!("rate-{name}")) else { continue };
            let points = Mark::points(rate.column("dt")?, shown(rate.column("rate")?));
            panel = panel.mark(
                points.role(method_color(method)).marker(libration_report::figure::Marker::Cross),
            );
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// Orbits at a large step: velocity Verlet beside RK4.
fn portraits(record: &Record, systems: &[(String, String)]) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("nonlinear-portraits", "Orbits at a large step")
        .caption(format!(
            "{} Position and velocity for one dimension, the plane of motion for two. Thin line: the \
             same start with small steps.",
            step_of_portraits(record, systems)
        ))
        .description("Points of orbits, one panel for each system and method.")
        .columns(2)
        .aspect(1.35);
    for (name, title) in systems {
        for method in [Method::VelocityVerlet, Method::Rk4] {
            let Ok(series) = record.series(&format!("portrait-{name}-{}", method.name())) else {
                continue;
            };
            let path = record.series(&format!("path-{name}"))?;
            let [x, y, dt, ..] = &series.columns[..] else { continue };
            let path = |column: &Column| path.column(&column.name).map(<[f64]>::to_vec);
            let (path_x, path_y) = (path(x)?, path(y)?);
            let reach = 1.3 * path_x.iter().chain(&path_y).fold(0.0_f64, |a, x| a.max(x.abs()));
            let dt = dt.values.first().copied().unwrap_or(f64::NAN);
            figure = figure.panel(
                Panel::new(
                    Axis::linear(x.name.clone()).range(-reach, reach),
                    Axis::linear(y.name.clone()).range(-reach, reach),
                )
                .title(format!("{title}: {}, Δt = {}", method.title(), seconds(dt, 2)))
                .equal()
                .mark(
                    Mark::points(x.values.clone(), y.values.clone())
                        .role(method_color(method))
                        .radius(1.4),
                )
                .mark(Mark::line(path_x, path_y).role(Role::Neutral).dash(Dash::Solid).width(0.7)),
            );
        }
    }
    Ok(figure)
}
