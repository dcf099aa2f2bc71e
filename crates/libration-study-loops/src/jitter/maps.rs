//! Figures of growth over time step and jitter.

use libration_report::figure::{Axis, ColorMap, Colors, Dash, Figure, Grid, Mark, Panel, Role};
use libration_report::record::{Record, RecordError};

/// The values of a rising series, each once.
fn distinct(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn grid(record: &Record, name: &str) -> Result<Grid, RecordError> {
    let series = record.series(name)?;
    let [x, y] = [distinct(series.column("dt")?), distinct(series.column("rms")?)];
    Ok(Grid { x, y, z: series.column("growth")?.to_vec() })
}

fn boundary(record: &Record, name: &str) -> Result<Mark, RecordError> {
    let series = record.series(name)?;
    Ok(Mark::line(series.column("dt")?, series.column("rms")?))
}

fn panel(title: &str) -> Panel {
    Panel::new(
        Axis::linear("time step Δt").unit("s"),
        Axis::log("rms jitter σ, as a part of a step").range(0.01, 0.3),
    )
    .title(title)
}

/// Both maps.
pub(super) fn maps(record: &Record) -> Result<Figure, RecordError> {
    let figure = Figure::new("jitter-map", "Growth over time step and jitter: velocity Verlet");
    if record.series("map-free").is_err() {
        return Ok(figure);
    }
    let few = "bounded over 10⁶ steps: left of this line";
    let free = Mark::raster(
        grid(record, "map-free")?,
        Colors::new("growth of ln |y| per step").log().range(1e-12, 1e-1),
    );
    let damped = Mark::raster(
        grid(record, "map-damped")?,
        Colors::new("growth of ln |y| per step").map(ColorMap::Diverging).range(-0.06, 0.06),
    );
    let line = |name: &str| boundary(record, name);
    Ok(figure
        .caption(
            "Colours: measured, 64 trajectories per cell, Gaussian jitter. Lines: predicted. Left: without damping the energy grows with any \
             jitter; the line is γN = ½ for a million steps. Right: with a damper of 0.06 ω; on \
             the solid line the Lyapunov exponent is zero, on the dashed one the growth of the mean square.",
        )
        .description("Two heat maps over Δt and σ with boundaries from upper left to lower right.")
        .columns(2)
        .aspect(1.05)
        .panel(
            panel("No damping")
                .mark(free)
                .mark(line("boundary-free")?.role(Role::Bad).dash(Dash::Solid).label(few)),
        )
        .panel(
            panel("With a damper")
                .mark(damped)
                .mark(
                    line("boundary-typical")?
                        .role(Role::Theory)
                        .dash(Dash::Solid)
                        .label("solid: exponent 0"),
                )
                .mark(
                    line("boundary-mean-square")?
                        .role(Role::Theory)
                        .dash(Dash::Dashed)
                        .label("dashed: radius 1"),
                ),
        ))
}
