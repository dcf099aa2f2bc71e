//! The figures of the chapter on rollouts.

use libration_report::figure::{Axis, Dash, Figure, Mark, Marker, Panel, Role};
use libration_report::notation::number;
use libration_report::record::{Record, RecordError};

use super::scaling::{EXECUTIONS, Varied, series_name};
use super::source_table::line;
use crate::source_rollouts::TABLE;

/// The inks of one core and of all, the same in every figure.
const INKS: [Role; 2] = [Role::Accent(0), Role::Accent(1)];

const CORES: [&str; 2] = ["one core", "all cores"];

/// Rates against environments and against the horizon, below fills of as much memory.
pub(super) fn scaling(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("fig-9-9", "Rollouts against environments and horizon")
        .caption(
            "Solid: rollouts. Dashed: fills of the same memory on the same number of cores. Left: a fixed horizon, with the rows of \
             the source’s table 9.11. Right: 1024 environments.",
        )
        .description("Log-log: transitions per second rise to a plateau below the fills.")
        .columns(2)
        .aspect(0.95);
    for varied in Varied::ALL {
        let mut panel = Panel::new(Axis::log(varied.name()), Axis::log("transitions per second"));
        for (i, execution) in EXECUTIONS.into_iter().enumerate() {
            let Ok(series) = record.series(&series_name(varied, execution)) else { continue };
            let x = series.column(varied.name())?;
            let rates = Mark::line(x, series.column("transitions_per_second")?);
            let fills = Mark::line(x, series.column("fill")?);
            panel = panel
                .mark(rates.role(INKS[i]).dash(Dash::Solid).label(CORES[i]))
                .mark(fills.role(INKS[i]).dash(Dash::Dashed).label(format!("fill, {}", CORES[i])));
        }
        if varied == Varied::Environments {
            let x = TABLE.map(|row| row.of.environments as f64);
            let rates = TABLE.map(|row| 1e6 * row.millions);
            panel = panel.mark(Mark::points(x, rates).role(Role::Neutral).label("the source"));
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// The time of a step of all environments: the source's, and one core's.
pub(super) fn steps(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("steps")?;
    let own = series.column("environments")?;
    let least = record.finding("rollout.step.least")?.measured;
    let [fewest, most] = [own.first(), own.last()].map(|x| x.copied().unwrap_or(f64::NAN));
    let along: Vec<f64> =
        (0..=60).map(|i| fewest * (most / fewest).powf(f64::from(i) / 60.0)).collect();
    let reported = line();
    let fitted: Vec<f64> = along.iter().map(|&n| reported.at(n)).collect();
    let x = TABLE.map(|row| row.of.environments as f64);
    let panel = Panel::new(Axis::log("environments"), Axis::log("time of a step").unit("s"))
        .mark(
            Mark::line(along, fitted)
                .role(Role::Neutral)
                .dash(Dash::Dashed)
                .label("a + b·N through the source"),
        )
        .mark(Mark::points(x, TABLE.map(|row| row.step())).role(Role::Neutral).label("the source"))
        .mark(Mark::line(own, series.column("seconds")?).role(INKS[0]).label(CORES[0]));
    Ok(Figure::new(
        "step-times",
        format!(
            "Time of a step: {} µs in the source with few environments, {} µs here with {fewest}",
            number(1e6 * reported.fixed, 2),
            number(1e6 * least, 2)
        ),
    )
    .caption(
        "On the flat part of a curve more environments take no more time, and the rate of transitions rises with their number.",
    )
    .description("Log-log: time of a step against environments, flat at first and then in proportion.")
    .panel(panel))
}

/// Rates in the four rows of table 9.11.
pub(super) fn summary(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("summary")?;
    let places: Vec<f64> = (0..TABLE.len()).map(|row| -(row as f64)).collect();
    let names = TABLE.map(|row| row.of.title());
    let mut panel = Panel::new(Axis::log("transitions per second"), Axis::names("", names));
    let all = [
        ("source", "the source", Role::Neutral, Marker::Square),
        ("numpy", "NumPy", Role::Accent(2), Marker::Diamond),
        ("one", "one core", INKS[0], Marker::Circle),
        ("all", "all cores", INKS[1], Marker::Circle),
    ];
    for (column, label, ink, marker) in all {
        let rates = series.column(column)?;
        if rates.iter().any(|rate| rate.is_finite()) {
            let points = Mark::points(rates, places.clone()).role(ink).marker(marker);
            panel = panel.mark(points.radius(4.0).label(label));
        }
    }
    Ok(Figure::new("fig-9-11", "Rollouts of table 9.11: source and this run")
        .caption("Environments × steps; interleaved, with the faster stores, into reused tensors.")
        .description("Points by row on a logarithmic axis of transitions per second.")
        .aspect(2.2)
        .panel(panel))
}
