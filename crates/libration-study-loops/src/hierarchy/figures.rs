//! The figures of the chapter on the hierarchy.

use libration_report::figure::{Axis, Figure, Mark, Panel, Role};
use libration_report::record::{Record, RecordError};

use super::SHORT;
use super::imperfection::{Kind, PROFILES};

fn role_of(kind: Kind) -> Role {
    match kind {
        Kind::Latency => Role::ExplicitEuler,
        Kind::Jitter => Role::SymplecticEuler,
        Kind::Asynchrony => Role::VelocityVerlet,
        Kind::Precision => Role::Rk4,
    }
}

/// The divergences of every profile, up to so many steps.
fn divergences(record: &Record, figure: Figure, last: f64) -> Result<Figure, RecordError> {
    let mut figure = figure.columns(2).aspect(1.2);
    for profile in PROFILES {
        let series = record.series(&format!("profile-{}", profile.tag))?;
        let steps = series.column("step")?;
        let shown = steps.iter().take_while(|&&n| n <= last).count();
        let mut panel = Panel::new(Axis::log("steps"), Axis::log("distance / size of the orbit"))
            .title(profile.title);
        for kind in Kind::ALL {
            // Beyond ten times the orbit nobody asks any more.
            let column = |name: &str| -> Result<Vec<f64>, RecordError> {
                let values = series.column(name)?[..shown].iter();
                Ok(values.map(|&d| if d > 0.0 && d < 10.0 { d } else { f64::NAN }).collect())
            };
            let every = |values: Vec<f64>| values.into_iter().step_by(3).collect::<Vec<f64>>();
            let expected = every(column(&format!("{}_predicted", kind.tag()))?);
            panel = panel.mark(
                Mark::line(&steps[..shown], column(kind.tag())?)
                    .role(role_of(kind))
                    .label(kind.title()),
            );
            if expected.iter().any(|d| !d.is_nan()) {
                panel = panel.mark(Mark::prediction(every(steps[..shown].to_vec()), expected));
            }
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// Over the short horizon.
pub(super) fn short(record: &Record) -> Result<Figure, RecordError> {
    let figure = Figure::new("hierarchy-short", "Four imperfections, over a thousand steps")
        .caption(
            "Distance from the undisturbed orbit, root mean square over starts around it. Lines: \
             simulated. Circles: predicted.",
        )
        .description("Log-log: distance against steps, a line for each imperfection, a panel for each choice of sizes.");
    divergences(record, figure, SHORT as f64)
}

/// Over the long one.
pub(super) fn long(record: &Record) -> Result<Figure, RecordError> {
    let figure = Figure::new("hierarchy-long", "Four imperfections, over a long horizon")
        .caption(
            "As above, over a longer horizon. The order depends on the sizes and on the horizon: latency \
             grows exponentially, asynchrony as n, jitter as √n.",
        )
        .description("Log-log: distance against steps, a line for each imperfection, a panel for each choice of sizes.");
    divergences(record, figure, f64::INFINITY)
}
