//! The figure of the chapter on what is kept.

use libration_report::figure::{Axis, Figure, Ink, Mark, Panel};
use libration_report::notation::number;
use libration_report::record::{Record, RecordError};

use super::draws::COLUMNS;

/// Times against the transitions that a buffer holds.
pub(super) fn draws(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("draws")?;
    let kept = series.column("transitions")?;
    let mut panel = Panel::new(Axis::log("transitions kept"), Axis::log("time of one").unit("ns"));
    for (i, (name, done)) in COLUMNS.into_iter().enumerate() {
        let line = Mark::line(kept, series.column(name)?);
        panel = panel.mark(line.ink(Ink::Accent(i as u8)).label(done));
    }
    Ok(Figure::new("draws", title(record)?)
        .caption(
            "Transitions of 17 bytes, one core, batches of 256, rollouts of 64 × 16. An insertion and a uniform draw take the same \
             operations however much is kept; a draw by priority goes down a tree of eights, one level more for eight times as much. \
             What else rises are waits for memory.",
        )
        .description("Log-log: time of a transition against the number that is kept.")
        .panel(panel))
}

/// How much dearer more of them make everything.
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
        "{} times as many transitions, and each is inserted or drawn in at most {} times the time",
        number(larger, 4),
        number(most, 2)
    ))
}
