//! Figures of walks, of the spectrum and of switching.

use libration_report::figure::{Axis, Dash, Figure, Mark, Marker, Panel, Role};
use libration_report::notation::seconds;
use libration_report::record::{Record, RecordError};

use super::energy::{DT, RMS};

/// Phases against steps.
pub(super) fn phases(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("jitter-phase", "Random walk of the phase with jitter")
        .number("9.12")
        .caption(
            "Standard deviation of the phase relative to nominal time (upper line) and relative to elapsed time \
             (lower line). Circles: predicted, zσ√n and aσ√(n/2).",
        )
        .description("Log-log: two lines of slope one half, far apart, on their predictions.")
        .columns(2)
        .aspect(1.3);
    for series in record.series.iter().filter(|s| s.name.starts_with("phase-")) {
        let steps = series.column("steps")?;
        let rms = series.column("rms")?.first().map_or(f64::NAN, |rms| 100.0 * rms);
        let rest = series.name.trim_start_matches("phase-");
        let (method, dt) = rest.rsplit_once('-').unwrap_or((rest, ""));
        let dt = dt.parse().map_or_else(|_| dt.to_owned(), |dt| seconds(dt, 2));
        let method = libration::Method::from_name(method).map_or(method, |m| m.title());
        let line = |name: &str, words: &str, ink| {
            Ok::<_, RecordError>(Mark::line(steps, series.column(name)?).role(ink).label(words))
        };
        let circles =
            |name: &str| Ok::<_, RecordError>(Mark::prediction(steps, series.column(name)?));
        figure = figure.panel(
            Panel::new(Axis::log("steps n"), Axis::log("deviation of the phase").unit("rad"))
                .title(format!("{method}, Δt = {dt}, σ = {rms} %"))
                .mark(line("nominal", "against nominal time", Role::Accent(0))?)
                .mark(line("elapsed", "against elapsed time", Role::Accent(3))?)
                .mark(circles("nominal-predicted")?.label("predicted"))
                .mark(circles("elapsed-predicted")?),
        );
    }
    Ok(figure)
}

/// Energies against steps.
pub(super) fn energies(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("jitter-energy", "Random walk of the energy with jitter")
        .number("9.13")
        .caption(
            "Root mean square of ln E/E₀ under Gaussian jitter of 5 %, along the ellipse of a steady step. Circles: \
             predicted, 2√(γn) and from n = 1/γ on 2γn; above 1 the energy is no longer bounded. In the first quarter of \
             a turn the walk depends on the start.",
        )
        .description("Log-log: lines of slope one half that bend to slope one.")
        .columns(2)
        .aspect(1.15);
    let rms = RMS[1];
    for method in [libration::Method::SymplecticEuler, libration::Method::VelocityVerlet] {
        let axes = (Axis::log("steps n"), Axis::log("rms of ln E/E₀"));
        let mut panel = Panel::new(axes.0, axes.1).title(method.title());
        let mut any = false;
        for (i, dt) in DT.iter().enumerate() {
            let Ok(series) = record.series(&format!("energy-{}-{dt}-{rms}", method.name())) else {
                continue;
            };
            let steps = series.column("steps")?;
            let line = Mark::line(steps, series.column("measured")?).role(Role::Accent(i as u8));
            panel = panel
                .mark(line.label(format!("Δt = {}", seconds(*dt, 2))))
                .mark(Mark::prediction(steps, series.column("predicted")?));
            any = true;
        }
        if any {
            figure = figure.panel(panel.mark(Mark::horizontal(1.0).role(Role::Bad)));
        }
    }
    Ok(figure)
}

/// Growth against the memory of jitter.
pub(super) fn memory(record: &Record) -> Result<Figure, RecordError> {
    let axes = Panel::new(
        Axis::linear("correlation of a step with the next"),
        Axis::log("γ, in units of that of white jitter"),
    );
    let mut panel = axes;
    for (i, z) in ["0.3", "0.95"].iter().enumerate() {
        let Ok(curve) = record.series(&format!("memory-{z}-predicted")) else { continue };
        let ink = Role::Accent(2 * i as u8);
        let line = Mark::line(curve.column("correlation")?, curve.column("growth")?).role(ink);
        panel =
            panel.mark(line.label(format!("predicted, ωΔt = {z}")).dash(Dash::Solid).width(1.2));
        let found = record.series(&format!("memory-{z}"))?;
        let points = Mark::points(found.column("correlation")?, found.column("growth")?).role(ink);
        let marker = [Marker::Circle, Marker::Square][i];
        panel = panel.mark(points.marker(marker).radius(4.0).label(format!("measured, ωΔt = {z}")));
    }
    Ok(Figure::new("jitter-memory", "Growth and correlation of jitter")
        .caption("Symplectic Euler under autoregressive jitter of 1 %. Lines: S(2θ)/σ², with the power spectrum S.")
        .description("Growth against correlation: points on curves that have a maximum.")
        .panel(panel))
}

/// Growth against the frequency of a swing.
pub(super) fn resonance(record: &Record) -> Result<Figure, RecordError> {
    let Ok(series) = record.series("resonance") else {
        return Ok(Figure::new("jitter-resonance", ""));
    };
    let weak = record.series("resonance-weak")?;
    let rate = series.column("rate")?;
    let middle = series.column("twice-angle")?.first().copied().unwrap_or(f64::NAN);
    let white = series.column("white")?.first().copied().unwrap_or(f64::NAN);
    let measured = Mark::points(rate, series.column("measured")?).role(Role::SymplecticEuler);
    let weak = Mark::line(weak.column("rate")?, weak.column("growth")?).role(Role::Neutral);
    let panel = Panel::new(
        Axis::linear("frequency of the step times").unit("rad per step"),
        Axis::linear("growth of ln |y| per step"),
    )
    .mark(Mark::horizontal(white).role(Role::Accent(1)).label("white jitter of the same σ"))
    .mark(Mark::vertical(middle).role(Role::Neutral).label("2θ"))
    .mark(weak.dash(Dash::Solid).width(1.2).label("weak jitter: √((aσ)²/2 − δ²/4)"))
    .mark(
        Mark::prediction(rate, series.column("predicted")?)
            .radius(5.0)
            .label("predicted: product of a period"),
    )
    .mark(measured.radius(2.4).label("measured"));
    Ok(Figure::new("jitter-resonance", "Resonance of a clock at twice the angle of a step")
        .caption("Symplectic Euler at ωΔt = 0.95, step times that vary as a sine with σ = 5 %.")
        .description(
            "Growth against frequency: an arch above twice the angle of a step, zero elsewhere.",
        )
        .panel(panel))
}

/// Sizes under steps that alternate.
pub(super) fn switching(record: &Record) -> Result<Figure, RecordError> {
    let mut panel = Panel::new(Axis::linear("steps"), Axis::log("√(E/E₀)").range(1e-8, 1e8));
    for (name, words, ink) in [
        ("short", "steps of nominal length", Role::Good),
        ("long", "steps twice as long", Role::Accent(0)),
        ("worst", "both lengths, in the worst order", Role::Bad),
    ] {
        let Ok(series) = record.series(&format!("switching-{name}")) else { continue };
        let line = Mark::line(series.column("steps")?, series.column("size")?);
        panel = panel.mark(line.role(ink).label(words).width(1.4));
    }
    let panel = Panel { x: panel.x.range(0.0, 400.0), ..panel };
    Ok(Figure::new("jitter-switching", "Instability of two stable step lengths in alternation")
        .caption(
            "Velocity Verlet at ωΔt = 0.9 with a damper of 0.15 ω, which is sampled once per step. A \
             missed tick doubles the length of a step.",
        )
        .description("Size against steps: two lines fall, the third rises.")
        .panel(panel))
}
