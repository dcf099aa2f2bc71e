//! The figures of the chapter on throughput.

use libration_report::figure::{Axis, Colors, Dash, Figure, Grid, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::record::{Record, RecordError};
use libration_study::Machine;

use super::render::shown;
use super::scaling::series_name;
use crate::bench::{BenchFloat, Implementation};

/// The ink of an implementation, the same in every figure.
fn role_of(implementation: Implementation) -> Role {
    match implementation {
        Implementation::Dynamic => Role::Accent(5),
        Implementation::Scalar => Role::Accent(4),
        Implementation::Temporaries => Role::Accent(2),
        Implementation::InPlace => Role::Accent(1),
        Implementation::OneStep => Role::Accent(3),
        Implementation::Fused => Role::Accent(0),
        Implementation::Threads => Role::SymplecticEuler,
    }
}

/// Rates against the number of trajectories, a panel for each float.
pub(super) fn scaling(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("fig-9-7", title(record))
        .caption(
            "Circles are predicted: the scalar loop by the latency of the arithmetic of one \
             trajectory (the processor may overlap it with the next), fused steps by independent \
             arithmetic, one step per pass by a loop that moves the same memory. Vertical lines: \
             two arrays fill a cache.",
        )
        .description("Log-log: steps per second against the number of trajectories.")
        .columns(2)
        .aspect(0.95);
    for float in BenchFloat::ALL {
        let mut panel = Panel::new(Axis::log("trajectories N"), Axis::log("steps per second"))
            .title(float.name());
        for cache in Machine::detect().caches {
            let holds = cache.bytes as f64 / (2 * float.bytes()) as f64;
            panel = panel.mark(
                Mark::vertical(holds).role(Role::Neutral).label(format!("cache {}", cache.level)),
            );
        }
        for implementation in shown(record) {
            let Ok(series) = record.series(&series_name(implementation, float)) else { continue };
            let counts = series.column("trajectories")?;
            let rates = series.column("steps_per_second")?;
            let line = Mark::line(counts, rates).role(role_of(implementation));
            panel = panel.mark(line.label(implementation.title()));
            let last = counts.last().copied().unwrap_or(f64::NAN);
            if let Some(rate) = predicted(record, implementation, float, last) {
                panel = panel.mark(Mark::prediction([last], [rate]));
            }
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

/// The rate that theory gives an implementation for `count` trajectories, if it gives one.
fn predicted(
    record: &Record,
    implementation: Implementation,
    float: BenchFloat,
    count: f64,
) -> Option<f64> {
    let of_float = |table: &str, column: usize| {
        let rows = &record.table(table).ok()?.rows;
        let mut rows = rows.iter().filter(|row| row[1] == float.name().into());
        rows.find(|row| row[0] == "symplectic Euler".into())?[column].value()
    };
    match implementation {
        Implementation::Scalar => Some(1e9 / of_float("a lone trajectory", 4)?),
        // A loop that is beaten by more than noise is no prediction.
        Implementation::Fused if of_float("fused steps", 5)? > 1.1 => None,
        Implementation::Fused => Some(1e9 * of_float("fused steps", 4)?),
        Implementation::OneStep if float == BenchFloat::F32 => {
            let rows = &record.table("one step a pass").ok()?.rows;
            let row = rows.iter().find(|row| row[0].value() == Some(count))?;
            Some(1e9 * row[3].value()?)
        }
        _ => None,
    }
}

fn title(record: &Record) -> String {
    let gain = record.finding("throughput.fused-over-in-place.f32.1e5").map(|f| f.measured);
    match gain {
        Ok(gain) => format!(
            "Fused steps are {} times as fast as array operations at N = 10⁵",
            number(gain, 2)
        ),
        Err(_) => "Steps per second against the number of trajectories".into(),
    }
}

/// The same in colour: implementation and float against the number of trajectories.
pub(super) fn heat(record: &Record) -> Result<Figure, RecordError> {
    let mut names = Vec::new();
    let mut rows: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for implementation in shown(record) {
        for float in BenchFloat::ALL {
            let Ok(series) = record.series(&series_name(implementation, float)) else { continue };
            let column = |name: &str| series.column(name).map(<[f64]>::to_vec);
            names.push(format!("{}, {}", implementation.title(), float.name()));
            rows.push((column("trajectories")?, column("steps_per_second")?));
        }
    }
    let counts = rows.iter().map(|(counts, _)| counts).max_by_key(|counts| counts.len());
    let counts = counts.cloned().unwrap_or_default();
    let rate = |count: f64, row: f64| {
        let (own, rates) = &rows[(-row) as usize];
        own.iter().position(|&n| n == count).map_or(f64::NAN, |at| rates[at])
    };
    let places: Vec<f64> = (0..names.len()).rev().map(|row| -(row as f64)).collect();
    // Cells have equal widths: where numbers are not evenly spaced, each stands for those that are nearest.
    let across = if evenly_spaced(&counts) { counts.clone() } else { between(&counts) };
    let nearest = |x: f64| {
        let off = |count: &&f64| (*count / x).ln().abs();
        counts.iter().min_by(|a, b| off(a).total_cmp(&off(b))).copied().unwrap_or(x)
    };
    let grid = Grid::sample(across, places, |x, row| rate(nearest(x), row));
    let colors = Colors::new("steps per second").log().unit("1/s");
    let axis = Axis::log("trajectories N");
    let panel = Panel::new(axis, Axis::names("", names)).mark(Mark::raster(grid, colors));
    Ok(Figure::new("fig-9-8", "Speed by implementation and number of trajectories")
        .caption("Blank: too little memory, or a scalar loop beyond the measured range.")
        .description("Heat map: steps per second by implementation and number of trajectories.")
        .aspect(1.6)
        .panel(panel))
}

/// Many numbers, evenly spaced on a logarithmic axis from the first of these to the last.
fn between(counts: &[f64]) -> Vec<f64> {
    const COLUMNS: i32 = 240;
    let [first, last] = [counts.first(), counts.last()].map(|x| x.copied().unwrap_or(1.0).ln());
    let step = (last - first) / f64::from(COLUMNS);
    (0..=COLUMNS).map(|i| (first + step * f64::from(i)).exp()).collect()
}

/// Whether each number is the same multiple of the one before, but for rounding.
fn evenly_spaced(counts: &[f64]) -> bool {
    let ratios: Vec<f64> = counts.windows(2).map(|pair| pair[1] / pair[0]).collect();
    ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).abs() < 1e-6)
}

/// Operations a second against arithmetic intensity.
pub(super) fn roofline(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("roofline")?;
    let x = series.column("intensity")?;
    let steps = series.column("steps_per_pass")?;
    let most = steps.iter().copied().fold(0.0, f64::max);
    let gain = series.column("attained")?;
    let gain = gain.iter().copied().fold(0.0, f64::max) / gain.first().copied().unwrap_or(f64::NAN);
    let panel = Panel::new(
        Axis::log("operations per byte"),
        Axis::log("operations per second").unit("1/s"),
    )
    .mark(
        Mark::line(x, series.column("at_once")?).role(Role::Neutral).label("memory or arithmetic"),
    )
    .mark(Mark::line(x, series.column("attained")?).role(Role::Accent(0)).label("fused steps"))
    .mark(
        Mark::prediction(x, series.column("in_turn")?)
            .dash(Dash::Solid)
            .label("without any overlap"),
    );
    Ok(Figure::new(
        "roofline",
        format!(
            "With {most} steps per pass the same memory traffic gives {} times the work",
            number(gain, 2)
        ),
    )
    .caption(
        "Symplectic Euler in f32 on one core, on the largest arrays of this run, 1 to 128 steps \
         per pass. The roof is the lower of measured bandwidth and measured arithmetic; circles: \
         the rate without overlap of arithmetic and memory accesses.",
    )
    .description("Log-log: operations per second against operations per byte, below two roofs.")
    .panel(panel))
}

#[cfg(test)]
mod tests {
    use super::{between, evenly_spaced};

    #[test]
    fn powers_are_evenly_spaced_and_other_numbers_are_not() {
        assert!(evenly_spaced(&[1.0, 10.0, 100.0]));
        assert!(evenly_spaced(&[]));
        assert!(!evenly_spaced(&[1.0, 10.0, 50.0]));
        let filled = between(&[1.0, 10.0, 50.0]);
        assert!(evenly_spaced(&filled) && (filled[filled.len() - 1] - 50.0).abs() < 1e-9);
    }
}
