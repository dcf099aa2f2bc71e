//! The figure of the chapter on what is kept.

use super::draws::COLUMNS;
use crate::figure::{Axis, Figure, Ink, Mark, Panel};
use crate::record::{Record, RecordError};

/// Times against the transitions that a buffer holds.
pub(super) fn draws(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("draws")?;
    let kept = series.column("transitions")?;
    let mut panel = Panel::new(Axis::log("transitions kept"), Axis::log("time of one").unit("ns"));
    for (i, (name, done)) in COLUMNS.into_iter().enumerate() {
        let line = Mark::line(kept, series.column(name)?);
        panel = panel.mark(line.ink(Ink::Accent(i as u8)).label(done));
    }
    Ok(Figure::new("draws", "What is kept does not make insertion dearer, and draws by the caches that it leaves")
        .caption(
            "Transitions of 17 bytes, one core, batches of 256, rollouts of 64 × 16. An insertion and a uniform draw take the same \
             operations however much is kept; a draw by priority goes down a tree of eights, one level more for eight times as much.",
        )
        .description("Log-log: time of a transition against the number that is kept, nearly flat.")
        .panel(panel))
}
