//! The chapter on what is kept.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::figures;
use crate::changed;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Replay, data sets, checkpoints".into();
    answer(record, page)?;
    page.paragraph(
        "A learner draws batches from the transitions that were seen last; an engineer keeps more of them than memory holds. \
         Speeds are medians of rounds in which each takes its turn with a copy of as many bytes, in memory or to the same \
         disk; to the disk means past the system’s cache, and waited for. A checkpoint is compared with as many bytes as are kept \
         and taken up; those it takes up come from the system’s cache.",
    );
    page.table(record.table("speeds")?, 3);
    if let Ok(peers) = record.table("peers") {
        page.paragraph(
            "The same batches from a buffer of cpprb as large, and pyarrow writing the same columns with the same settings from \
             memory; by `benches/storage.py`, each in turn.",
        );
        page.table(peers, 3);
    }
    page.heading("A circle of transitions");
    page.paragraph(
        "Transitions are kept once: what is seen next is the next row, or stands apart where an episode ended. So a buffer \
         takes the 17 bytes of a transition, where the usual way takes 25, and room for as many ends as it is given.",
    );
    page.figure(figures::draws(record)?);
    page.heading("What changes no byte");
    page.paragraph(
        "Data sets of environments with random starts, time limits, latencies, jitter, skew and noise, in twelve chunks: written \
         on several threads, stopped twice and gone on with, and in shards. Of each file the checksum is compared.",
    );
    page.table(changed::table(record)?, 4);
    Ok(())
}

/// How fast the disk is filled, what a batch takes, and whether anything differs.
fn answer(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    let value = |id: &str| record.finding(id).map(|f| f.measured);
    let million = |rate: f64| format!("{}·10⁶", number(rate / 1e6, 3));
    let (npy, share) = (value("storage.npy.rate")?, value("storage.npy")?);
    let batch = 1e6 / value("storage.sample.rate")?;
    let weighed = 1e6 / value("storage.prioritised.rate")?;
    let kept = record.findings.iter().filter(|f| f.id.starts_with("storage.kept."));
    let (all, same) = kept.fold((0, 0), |(all, same), f| (all + 1, same + usize::from(f.agrees())));
    page.answer = format!(
        "Data sets go to this disk at {} transitions a second, {} % of what it takes at all. A batch of 256 is drawn from a \
         million transitions in {} µs, by priority and with other priorities given in {} µs. {same} of {all} changes that must \
         not change a byte change none.",
        million(npy),
        number(100.0 * share, 2),
        number(batch, 2),
        number(weighed, 2)
    );
    page.highlights.push(Highlight {
        value: million(npy),
        text: "transitions a second to the disk, each with its checksum".into(),
    });
    Ok(())
}
