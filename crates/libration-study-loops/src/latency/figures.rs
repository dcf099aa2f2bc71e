//! The figures of the chapter on latency.

use libration_report::figure::{Axis, ColorMap, Colors, Dash, Figure, Grid, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::record::{Record, RecordError};
use libration_study::source_report::DT;

use super::critical_latency::MARGIN;
use super::map;
use super::map::{Kind, METHODS};

/// Latencies of the force of which orbits are shown.
const LATE: [u8; 5] = [0, 1, 2, 5, 10];

/// The amplitude after a short run, against latency.
pub(super) fn short(record: &Record) -> Result<Figure, RecordError> {
    let (mut x, mut y, mut forecast) = (Vec::new(), Vec::new(), Vec::new());
    for late in LATE {
        let series = record.series(&format!("force-{late}"))?;
        let steps = series.column("step")?;
        let Some(i) = steps.iter().position(|&n| n == super::late_force::SHORT as f64) else {
            continue;
        };
        x.push(f64::from(late));
        y.push(series.column("amplitude")?[i]);
        forecast.push(series.column("predicted")?[i]);
    }
    let panel = Panel::new(
        Axis::linear("latency of the force (steps)"),
        Axis::linear("amplitude after 1000 steps").unit("m"),
    )
    .mark(
        Mark::line(x.clone(), y)
            .role(Role::SymplecticEuler)
            .dash(Dash::Solid)
            .label("symplectic Euler"),
    )
    .mark(Mark::prediction(x, forecast).label("predicted"));
    Ok(Figure::new("fig-9-14", "Amplitude and latency of the force")
        .number("9.14")
        .caption(format!(
            "The source’s oscillator, Δt = {} s, after 1000 steps. Line: simulated. Circles: predicted from the \
             amplitude after 100 steps and the spectral radius of the step with its latency.",
            number(DT, 3)
        ))
        .description("The amplitude rises almost in proportion to the latency.")
        .aspect(2.2)
        .panel(panel))
}

/// The amplitude over the long run, a line for each latency.
pub(super) fn long(record: &Record) -> Result<Figure, RecordError> {
    let mut panel = Panel::new(Axis::linear("steps"), Axis::log("amplitude").unit("m"));
    for (i, late) in LATE.into_iter().enumerate() {
        let series = record.series(&format!("force-{late}"))?;
        let steps = series.column("step")?;
        let label = if late == 0 { "no latency".to_owned() } else { format!("{late} late") };
        panel = panel
            .mark(
                Mark::line(steps, series.column("amplitude")?)
                    .role(Role::Accent(i as u8))
                    .label(label),
            )
            .mark(Mark::prediction(steps, series.column("predicted")?));
    }
    Ok(Figure::new("fig-9-15", "Amplitude over a million steps with latencies of the force")
        .number("9.15")
        .caption(
            "Amplitudes of the source’s oscillator with its force 0, 1, 2, 5 and 10 steps of 1 ms \
             late. Lines: simulated. Circles: predicted. With a latency of one step symplectic \
             Euler is explicit Euler, bit for bit.",
        )
        .description("Straight lines on a logarithmic axis, steeper for longer latencies.")
        .panel(panel))
}

/// Growth against latency, through all windows.
pub(super) fn windows(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("windows")?;
    let x = series.column("latency")?;
    let panel = Panel::new(
        Axis::linear("latency of the command (steps)"),
        Axis::linear("ln ρ, growth per step"),
    )
    .mark(Mark::horizontal(0.0).role(Role::Neutral).width(0.8))
    .mark(
        Mark::line(x, series.column("measured")?)
            .role(Role::VelocityVerlet)
            .dash(Dash::Solid)
            .label("measured"),
    )
    .mark(Mark::prediction(x, series.column("predicted")?).label("predicted"));
    Ok(Figure::new("latency-windows", "Windows of stability at larger latencies")
        .caption(
            "Velocity Verlet, Δt = 10 ms, feedback of the velocity alone, K = (0, 1). Below the line the loop is \
             stable. Every whole latency was simulated; circles are spectral radii.",
        )
        .description("The growth crosses zero several times as the latency rises.")
        .aspect(2.2)
        .panel(panel))
}

/// A map for each method, with the edges of theory.
pub(super) fn map(record: &Record, kind: Kind) -> Result<Figure, RecordError> {
    let margin = margin(record)?;
    let (id, title) = match kind {
        Kind::Gain => ("latency-map-gain", "Stability by latency and gain"),
        Kind::Step => ("latency-map-step", "Stability by latency and time step"),
    };
    let caption = match kind {
        Kind::Gain => "Colour: growth per step of simulated loops, a run for each whole latency \
                       and gain; blue decays. Lines: ρ = 1, from the shipped step. Feedback of the \
                       velocity alone, K = (0, K_d), ω² = 10 s⁻², Δt = 40 ms. In the lobes beyond \
                       the first the latency is about a whole number of periods: a weak command \
                       that is late by a period still damps."
            .to_owned(),
        Kind::Step => format!(
            "Colour: growth per step of simulated loops; blue decays. Solid: ρ = 1, from the \
             shipped step. Dashed: the delay margin of the continuous loop, {} s. The difference \
             is the hidden latency of the integrator and the zero-order hold. {}, ω² = 10 s⁻².",
            number(margin, 5),
            map::gains()
        ),
    };
    let mut figure = Figure::new(id, title)
        .caption(caption)
        .description(
            "Heat maps of the growth of a loop, with the boundary of stability drawn over them.",
        )
        .columns(2)
        .aspect(1.35);
    for method in METHODS {
        let series = record.series(&format!("map-{}-{}", kind.name(), method.name()))?;
        let columns = kind.longest() as usize + 1;
        let x = series.column("latency")?[..columns].to_vec();
        let y: Vec<f64> = series.column(kind.name())?.iter().step_by(columns).copied().collect();
        let (reach, digits) = if kind == Kind::Gain { (0.02, 1e4) } else { (0.1, 1e3) };
        // No more digits than can be seen.
        let seen = |rate: &f64| (rate.clamp(-reach, reach) * digits).round() / digits;
        let z = series.column("growth")?.iter().map(seen).collect();
        let (low, high) = (y.first().copied().unwrap_or(0.0), y.last().copied().unwrap_or(1.0));
        let vertical = match kind {
            Kind::Gain => Axis::linear("gain of the velocity K_d").unit("s⁻¹"),
            Kind::Step => Axis::log("time step Δt").unit("s"),
        };
        let colors =
            Colors::new("ln ρ, growth per step").map(ColorMap::Diverging).range(-reach, reach);
        let across = Axis::linear("latency of the command (steps)");
        let across = across.range(-0.5, f64::from(kind.longest()) + 0.5);
        let mut panel = Panel::new(across, vertical.range(low, high))
            .title(method.title())
            .mark(Mark::raster(Grid { x, y, z }, colors));
        if kind == Kind::Step {
            let at = |i: u32| low * (high / low).powf(f64::from(i) / 200.0);
            let (x, y): (Vec<f64>, Vec<f64>) = (0..=200)
                .map(|i| (margin / at(i), at(i)))
                .filter(|(d, _)| *d <= f64::from(kind.longest()))
                .unzip();
            let line = Mark::line(x, y).role(Role::Neutral).dash(Dash::Dashed).width(1.4);
            panel = panel.mark(line.label("delay margin"));
        }
        // What is predicted lies over all else.
        panel = panel.marks(edges(record, kind, method)?);
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// The delay margin of the continuous loop, in s.
fn margin(record: &Record) -> Result<f64, RecordError> {
    let table = record.table("critical latencies")?;
    let row = table.rows.first().and_then(|row| row.get(MARGIN)?.value());
    Ok(row.unwrap_or(f64::NAN))
}

/// The edges of a map.
fn edges(record: &Record, kind: Kind, method: libration::Method) -> Result<Vec<Mark>, RecordError> {
    let series = record.series(&format!("edge-{}-{}", kind.name(), method.name()))?;
    let (line, x, y) =
        (series.column("line")?, series.column("latency")?, series.column(kind.name())?);
    let last = line.iter().copied().fold(-1.0, f64::max) as i64;
    let one = |k: i64| {
        let of = |column: &[f64]| -> Vec<f64> {
            let here = column.iter().zip(line).filter(|(_, line)| **line as i64 == k);
            here.map(|(value, _)| *value).collect()
        };
        let mark = Mark::line(of(x), of(y)).role(Role::Theory).dash(Dash::Solid).width(1.6);
        if k == 0 { mark.label("ρ = 1, predicted") } else { mark }
    };
    Ok((0..=last).map(one).collect())
}
