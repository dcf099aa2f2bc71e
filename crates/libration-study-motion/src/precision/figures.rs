//! The figures of the chapter on precision.

use libration_report::figure::{Axis, Figure, Mark, Panel, Role};
use libration_report::record::{Record, RecordError};

use super::float_type::FLOAT_TYPES;

/// The ink of a float type: the 24 bits of `f32` and the 53 of `f64` have their own.
fn series_color(i: usize) -> Role {
    match FLOAT_TYPES[i].name {
        "f64" => Role::Good,
        "f32" => Role::VelocityVerlet,
        _ => Role::Accent(i as u8),
    }
}

/// Returns every fourth value.
fn every(values: &[f64]) -> Vec<f64> {
    values.iter().copied().step_by(4).collect()
}

/// Drift against steps, for all types, with the prediction where there is one.
pub(super) fn types(record: &Record) -> Result<Figure, RecordError> {
    let mut panel = Panel::new(Axis::log("steps"), Axis::log("rms drift of the invariant"));
    for (i, kind) in FLOAT_TYPES.iter().enumerate() {
        let Ok(series) = record.series(&format!("type-{}", kind.name)) else { continue };
        let (step, drift) = (series.column("step")?, series.column("drift")?);
        let comparable = series.column("comparable")?;
        let predicted: Vec<f64> = series
            .column("drift_predicted")?
            .iter()
            .zip(comparable)
            .map(|(&drift, &comparable)| if comparable > 0.0 { drift } else { f64::NAN })
            .collect();
        panel = panel.mark(Mark::line(step, drift).role(series_color(i)).label(kind.name));
        if predicted.iter().any(|d| !d.is_nan()) {
            panel = panel.mark(Mark::prediction(every(step), every(&predicted)));
        }
    }
    Ok(Figure::new("precision-types", "Drift from rounding in eleven float types")
        .caption(
            "Root mean square over many orbits of the relative change of the invariant of velocity Verlet. \
             Lines: simulated. Circles: √n times the rounding error of single steps, if these are \
             independent and no orbit has closed.",
        )
        .description("Log-log: drift against the number of steps, a line for each float type.")
        .panel(panel))
}

/// Drift after all steps against the bits of the significand.
pub(super) fn bits(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("bits")?;
    let [bits, drift, predicted, compensated] = [
        series.column("bits")?,
        series.column("drift")?,
        series.column("drift_predicted")?,
        series.column("compensated")?,
    ];
    let only = |values: &[f64], which: f64| -> Vec<f64> {
        let pairs = values.iter().zip(compensated);
        pairs.map(|(&y, &c)| if c == which { y } else { f64::NAN }).collect()
    };
    let panel =
        Panel::new(Axis::linear("bits of the significand"), Axis::log("rms drift at the end"))
            .mark(Mark::points(bits, only(drift, 0.0)).role(Role::VelocityVerlet).label("plain"))
            .mark(Mark::points(bits, only(drift, 1.0)).role(Role::Accent(2)).label("compensated"))
            .mark(Mark::prediction(bits, predicted));
    Ok(Figure::new("precision-bits", "Drift against the bits of the significand")
        .caption(
            "After all steps. Each bit halves the drift, as predicted (circles), unless orbits close: \
             with few bits they close early, and the drift stops.",
        )
        .description("Drift on a logarithmic axis against the bits of the significand.")
        .panel(panel))
}

/// Both forms of Verlet in single precision.
pub(super) fn forms(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("precision-forms", "Drift of two forms of Verlet in f32")
        .caption(
            "The rounding of the textbook form is biased, and its drift grows as n; the product of kicks and drifts \
             has no bias, and its drift grows as √n. Lines: simulated. Circles: from the rounding of single steps.",
        )
        .description("Log-log: drift of two forms of Verlet against the number of steps.")
        .columns(2)
        .aspect(1.2);
    let prefix = "form-textbook-verlet-";
    let names = record.series.iter().filter_map(|s| s.name.strip_prefix(prefix));
    for tag in names {
        let title = tag.replacen("dt-", "Δt = ", 1) + " s";
        let mut panel = Panel::new(Axis::log("steps"), Axis::log("rms drift")).title(title);
        for (form, label, ink) in [
            ("textbook-verlet", "textbook", Role::TextbookVerlet),
            ("velocity-verlet", "kick–drift–kick", Role::VelocityVerlet),
        ] {
            let series = record.series(&format!("form-{form}-{tag}"))?;
            let step = series.column("step")?;
            let predicted = every(series.column("drift_predicted")?);
            panel = panel
                .mark(Mark::line(step, series.column("drift")?).role(ink).label(label))
                .mark(Mark::prediction(every(step), predicted));
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}
