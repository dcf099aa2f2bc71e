//! The chapter on energy drift.

use libration::Method;
use libration_report::figure::{Axis, Dash, Envelope, Figure, Mark, Panel, Role};
use libration_report::notation::{number, seconds};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError, Series};

use super::{actions, methods, tag};
use crate::method_color::method_color;

/// Unit roundoff of `f64`, where drift sinks into rounding.
const ROUNDING: f64 = 1.1e-16;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Energy drift".into();
    let steps = record.series.iter().filter(|s| s.name.starts_with("dt-"));
    let dts: Vec<f64> = steps.filter_map(|s| s.name["dt-".len()..].parse().ok()).collect();
    let Some((&first, &last)) = dts.first().zip(dts.last()) else { return Ok(()) };
    summary(record, page, first);
    actions::add(record, first, page);
    page.paragraph(
        "Each step multiplies a quadratic form by its determinant, `Q(My) = det M · Q(y)`, and the energy \
         lies between two multiples of that form. With determinant one and a stable step, the energy stays \
         in a band without limit of time; otherwise it grows or decays in every step. The \
         circles below are this envelope, derived from the shipped steps; the lines are simulated.",
    );
    page.figure(running(record, first)?.number("9.1"));
    page.figure(signed(record, first)?.number("9.2"));
    page.table(record.table("largest drift")?, 7);
    page.paragraph(
        "The predictions in the table are exact: the largest drift over the discrete orbit, from \
         powers of the update matrix with 1024 bits. The worst start is the phase of the same orbit \
         with the largest drift; the drift from the configured start may be smaller.",
    );
    for &dt in &dts[1..] {
        page.figure(running(record, dt)?.caption("As above, with a larger time step."));
    }
    if record.series("crossover").is_ok() {
        page.heading("Crossover of RK4 and Verlet");
        page.paragraph(
            "RK4 loses z⁶/72 of the energy per step, from any start. From rest the energy of Verlet \
             oscillates by z²/4, and the loss of RK4 exceeds this after 18/z⁴ steps. From a start in motion \
             both numbers differ; the line belongs to the configured start. Below the line RK4 has the \
             smaller energy error, although it is not symplectic.",
        );
        page.figure(crossover(record)?);
    }
    page.heading("Phase space");
    page.figure(portraits(record, last)?);
    Ok(())
}

/// The answer, from the findings at the smallest step.
fn summary(record: &Record, page: &mut Page, dt: f64) {
    let largest = |m: Method| {
        record.finding(&format!("drift.{}.{}.largest", m.name(), tag(dt))).ok().map(|f| f.measured)
    };
    let crossover = record
        .finding(&format!("drift.crossover.{}.leading-order", tag(dt)))
        .ok()
        .map(|f| f.measured);
    let shown = seconds(dt, 3);
    if let (Some(verlet), Some(rk4), Some(crossover)) =
        (largest(Method::VelocityVerlet), largest(Method::Rk4), crossover)
        && fills_its_band(record, dt)
    {
        page.headline = format!(
            "Relative energy error at Δt = {shown}: at most {} for velocity Verlet at all times, {} for \
             RK4 at the end. RK4 exceeds Verlet after {} steps.",
            number(verlet, 2),
            number(rk4, 2),
            number(crossover, 2)
        );
        page.highlights.push(Highlight {
            value: number(rk4, 3),
            text: format!("relative energy loss of RK4 at Δt = {shown}"),
        });
        page.highlights.push(Highlight {
            value: format!("{} steps", number(crossover, 2)),
            text: "until the energy error of RK4 exceeds that of Verlet".into(),
        });
    }
    let sizes: Vec<String> = methods(record)
        .into_iter()
        .filter_map(|m| Some(format!("{} {}", m.title(), number(largest(m)?, 3))))
        .collect();
    let left: Vec<String> = methods(record)
        .into_iter()
        .filter_map(|m| {
            let overflow =
                record.finding(&format!("drift.{}.{}.overflow", m.name(), tag(dt))).ok()?;
            Some(format!("; {} leaves the range of f64 at step {}", m.title(), overflow.measured))
        })
        .collect();
    page.answer = format!(
        "Largest relative energy drift at Δt = {shown}: {}{}. Each agrees with the prediction \
         from the step of its method.",
        sizes.join(", "),
        left.concat()
    );
}

/// Whether Verlet’s run was long enough for its energy to swing as far as it ever will.
fn fills_its_band(record: &Record, dt: f64) -> bool {
    let predicted = format!("{} predicted", Method::VelocityVerlet.name());
    let series = record.series(&tag(dt));
    let column = series.ok().and_then(|series| series.column(&predicted).ok());
    column.and_then(|column| column.last()).is_some_and(|size| size.is_finite())
}

/// The running maximum of the drift at one time step.
fn running(record: &Record, dt: f64) -> Result<Figure, RecordError> {
    let series = record.series(&tag(dt))?;
    let steps = series.column("step")?;
    let mut panel = Panel::new(Axis::log("steps"), Axis::log("largest |E − E₀|/E₀ so far"))
        .mark(Mark::horizontal(ROUNDING).label("rounding of f64").role(Role::Neutral));
    for method in methods(record) {
        let column = |what: &str| series.column(&format!("{} {what}", method.name()));
        let line = Mark::line(steps, shown(column("measured")?)).role(method_color(method));
        panel = panel.mark(line.label(method.title()));
        let (x, y) = each_half_decade(steps, column("predicted")?);
        panel = panel.mark(Mark::prediction(x, y));
    }
    let number =
        if tag(dt) == "dt-0.001" { "fig-9-1".into() } else { format!("drift-{}", tag(dt)) };
    Ok(Figure::new(number, format!("Largest energy drift so far, Δt = {}", seconds(dt, 3)))
        .caption(
            "Explicit Euler gains energy in every step. Within their stability limits the energy of \
             symplectic methods stays in a band, and RK4 loses energy in every step. \
             Lines: simulated in f64. Circles: the envelope that follows from the step, from the \
             first half-turn on.",
        )
        .description("Log-log: running maximum of the relative energy drift against steps.")
        .panel(panel))
}

/// Returns values below a million times the initial energy, and NaN beyond.
fn shown(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&y| if y < 1e6 { y } else { f64::NAN }).collect()
}

/// Every twelfth sample, which is two a decade.
fn each_half_decade(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let drawn = x.iter().zip(shown(y)).rev().step_by(12);
    drawn.map(|(&x, y)| (x, y)).unzip()
}

/// The signed drift along the horizon, without explicit Euler.
fn signed(record: &Record, dt: f64) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("fig-9-2", "Energy drift with its sign, without explicit Euler")
        .caption(
            "Scales differ between methods. From rest the energy of symplectic Euler oscillates up and down, \
             that of Verlet only down; RK4 loses energy monotonically. Shaded: lowest to highest drift in each \
             part of the run. Thin lines: the envelope that follows from the step.",
        )
        .description("The drift of each method against time, with its closed-form envelope.")
        .aspect(4.2);
    for method in methods(record).into_iter().filter(|&m| m != Method::ExplicitEuler) {
        let series = record.series(&format!("{}-{}", method.name(), tag(dt)))?;
        figure = figure.panel(band(method, series)?);
    }
    Ok(figure)
}

fn band(method: Method, series: &Series) -> Result<Panel, RecordError> {
    let column = |name: &str| series.column(name).map(<[f64]>::to_vec);
    let t = column("t")?;
    let envelope = Envelope { x: t.clone(), low: column("low")?, high: column("high")? };
    let bound = |name: &str| -> Result<Mark, RecordError> {
        Ok(Mark::line(t.clone(), column(name)?).role(Role::Theory).dash(Dash::Solid).width(0.9))
    };
    Ok(Panel::new(Axis::linear("time t").unit("s"), Axis::linear("(E − E₀)/E₀"))
        .title(method.title())
        .mark(Mark::envelope(envelope).role(method_color(method)))
        .mark(bound("bound_low")?)
        .mark(bound("bound_high")?))
}

/// The crossover against the time step.
fn crossover(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("crossover")?;
    let (dt, steps) = (series.column("dt")?, series.column("steps")?);
    let measured: (Vec<f64>, Vec<f64>) = dt
        .iter()
        .filter_map(|&dt| {
            let finding = record.finding(&format!("drift.crossover.{}.measured", tag(dt))).ok()?;
            Some((dt, finding.measured))
        })
        .unzip();
    let (low, high) = (dt.first().copied().unwrap_or(1e-3), dt.last().copied().unwrap_or(0.1));
    let predicted = Mark::line(dt, steps).role(Role::Theory).dash(Dash::Solid).width(1.2);
    let panel = Panel::new(Axis::log("time step Δt").unit("s"), Axis::log("steps"))
        .mark(predicted.label("predicted"))
        .mark(
            Mark::points(measured.0, measured.1)
                .role(method_color(Method::Rk4))
                .radius(4.5)
                .label("measured"),
        )
        .mark(Mark::horizontal(1e6).label("10⁶ steps").role(Role::Neutral));
    let note = |x: f64, y: f64, text: &str| Mark::note(x, y, text).role(Role::Neutral);
    let middle = (low * high).sqrt();
    let top = steps.iter().copied().filter(|s| s.is_finite()).fold(1.0, f64::max);
    Ok(Figure::new(
        "crossover",
        "Number of steps until the energy error of RK4 exceeds that of Verlet",
    )
    .caption(format!(
        "Above the line Verlet has the smaller energy error, below it RK4.{}",
        crossed(dt, steps)
    ))
    .description("Log-log: the crossover falls with the fourth power of the time step.")
    .aspect(2.2)
    .panel(panel.mark(note(middle * 1.6, top / 30.0, "Verlet better")).mark(note(
        low * 1.3,
        3e3,
        "RK4 better",
    ))))
}

/// Returns a sentence about the crossing of the line with the horizon of the source.
fn crossed(dt: &[f64], steps: &[f64]) -> String {
    const HORIZON: f64 = 1e6;
    let pairs = dt.windows(2).zip(steps.windows(2));
    let crossing = pairs.into_iter().find(|(_, n)| n[0] >= HORIZON && n[1] < HORIZON);
    crossing.map_or_else(String::new, |(dt, _)| {
        format!(
            " The horizon of the source, a million steps, crosses the line between Δt = {} and {}.",
            seconds(dt[0], 3),
            seconds(dt[1], 3)
        )
    })
}

/// The orbits of all methods at the largest time step.
fn portraits(record: &Record, dt: f64) -> Result<Figure, RecordError> {
    let mut figure =
        Figure::new("portraits", format!("Six turns in phase space at Δt = {}", seconds(dt, 3)))
            .caption(
                "Dots: the simulated orbit. Thin circle: the exact orbit. Lines: the invariant curve of the \
                 step: a tilted ellipse for symplectic Euler, an upright one for Verlet; for explicit Euler \
                 and RK4 circles that grow or shrink by √det M per step.",
            )
            .description("Phase portraits, one for each integrator.")
            .columns(2)
            .aspect(1.0);
    for method in methods(record) {
        let orbit = record.series(&format!("portrait-{}", method.name()))?;
        let curve = record.series(&format!("curve-{}", method.name()))?;
        let start = orbit
            .column("x")?
            .first()
            .copied()
            .unwrap_or(1.0)
            .hypot(orbit.column("v_over_omega")?.first().copied().unwrap_or(0.0));
        let (cx, cy): (Vec<f64>, Vec<f64>) = (0..=120)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 120.0)
            .map(|a| (start * a.cos(), start * a.sin()))
            .unzip();
        let reach = 1.75 * start;
        figure = figure.panel(
            Panel::new(
                Axis::linear("x").unit("m").range(-reach, reach),
                Axis::linear("v/ω").unit("m").range(-reach, reach),
            )
            .title(method.title())
            .equal()
            .mark(Mark::line(cx, cy).role(Role::Neutral).dash(Dash::Solid).width(0.8))
            .mark(
                Mark::line(curve.column("x")?, curve.column("v_over_omega")?)
                    .role(Role::Theory)
                    .dash(Dash::Solid)
                    .width(0.9),
            )
            .mark(
                Mark::points(orbit.column("x")?, orbit.column("v_over_omega")?)
                    .role(method_color(method))
                    .radius(2.0),
            ),
        );
    }
    Ok(figure)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predictions_are_drawn_twice_a_decade_and_not_beyond_the_figure() {
        let x: Vec<f64> = (0..=48).map(|i| 10_f64.powf(f64::from(i) / 24.0)).collect();
        let y: Vec<f64> = x.iter().map(|x| if *x > 50.0 { 1e40 } else { 1.0 }).collect();
        let (drawn, values) = each_half_decade(&x, &y);
        assert_eq!(drawn.len(), 5);
        assert_eq!(values.iter().filter(|y| y.is_nan()).count(), 1);
        assert_eq!(number(drawn[0], 3), "100");
    }
}
