//! The figure of the chapter on storage.

use libration_report::figure::{Axis, Figure, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::record::{Record, RecordError};

use super::sampling_cost::COLUMNS;

/// Times against the transitions that a buffer holds.
pub(super) fn draws(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("draws")?;
    let kept = series.column("transitions")?;
    let mut panel =
        Panel::new(Axis::log("transitions kept"), Axis::log("time per transition").unit("ns"));
    for (i, (name, done)) in COLUMNS.into_iter().enumerate() {
        let line = Mark::line(kept, series.column(name)?);
        panel = panel.mark(line.role(Role::Accent(i as u8)).label(done));
    }
    Ok(Figure::new("draws", title(record)?)
        .caption(
            "Transitions of 17 bytes, one core, batches of 256, rollouts of 64 × 16. The number of operations of an insertion and of a uniform draw is independent of the size of the \
             buffer; a draw by priority descends a tree with eight children per node, one level more for eight times the size. \
             The rest of the increase is memory latency.",
        )
        .description("Log-log: time per transition against the size of the buffer.")
        .panel(panel))
}

/// Returns a title with the increase of the times.
fn title(record: &Record) -> Result<String, RecordError> {
    let series = record.series("draws")?;
    let kept = series.column("transitions")?;
    let larger = kept.last().zip(kept.first()).map_or(f64::NAN, |(last, first)| last / first);
    let mut grown = Vec::new();
    for (name, _) in COLUMNS {
        grown.push(record.finding(&format!("storage.growth.{name}"))?.measured);
    }
    let most = grown.into_iter().fold(0.0, f64::max);
    Ok(format!(
        "With {} times as many transitions, an insertion or a draw takes at most {} times the time",
        number(larger, 4),
        number(most, 2)
    ))
}
