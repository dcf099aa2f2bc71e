//! The chapter on storage.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::figures;
use crate::bit_comparison;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Replay buffers, data sets, checkpoints".into();
    answer(record, page)?;
    page.paragraph(
        "A replay buffer has the latest transitions in memory; a data set has more transitions than memory. \
         Speeds are medians of rounds that alternate with a copy of the same number of bytes, in memory or to the same \
         disk. Writes to the disk include the flush of the system’s cache. A checkpoint is compared with a write and a read \
         of the same number of bytes; the read comes from the system’s cache.",
    );
    page.table(record.table("speeds")?, 3);
    if let Ok(peers) = record.table("peers") {
        page.paragraph(
            "The same batches from a cpprb buffer of the same size, and the same columns written by pyarrow with the same settings \
             from memory. `benches/storage.py` measures them alternately.",
        );
        page.table(peers, 3);
    }
    page.heading("Memory of a replay buffer");
    page.paragraph(
        "Each observation is stored once: the next observation is the next row, or a separate entry if the episode ended. A buffer \
         therefore takes 17 bytes per transition instead of the usual 25, plus the capacity for ends of episodes.",
    );
    page.figure(figures::draws(record)?);
    page.heading("Reproducibility of data sets");
    page.paragraph(
        "Data sets of environments with random starts, time limits, latencies, jitter, skew and noise, in twelve chunks: written \
         on several threads, interrupted and resumed twice, and in shards. The checksums of all files are compared.",
    );
    page.table(bit_comparison::table(record)?, 4);
    page.action("Check a data set after each copy: `libration verify data`.");
    page.action("Measure the disk before a long run: `libration bench --storage --folder DIR`.");
    Ok(())
}

/// Writes the answer: rate to the disk, time of a batch, and reproducibility.
fn answer(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    let value = |id: &str| record.finding(id).map(|f| f.measured);
    let million = |rate: f64| format!("{}·10⁶", number(rate / 1e6, 3));
    let (npy, share) = (value("storage.npy.rate")?, value("storage.npy")?);
    let batch = 1e6 / value("storage.sample.rate")?;
    let weighed = 1e6 / value("storage.prioritised.rate")?;
    let kept = record.findings.iter().filter(|f| f.id.starts_with("storage.kept."));
    let (all, same) = kept.fold((0, 0), |(all, same), f| (all + 1, same + usize::from(f.agrees())));
    page.answer = format!(
        "Data sets: {} transitions per second to this disk, {} % of its write rate. A batch of 256 \
         from a million transitions: {} µs, with priorities and their update {} µs. Threads, \
         interruptions and shards change no byte in {same} of {all} cases.",
        million(npy),
        number(100.0 * share, 2),
        number(batch, 2),
        number(weighed, 2)
    );
    page.highlights.push(Highlight {
        value: million(npy),
        text: "transitions per second to the disk, with checksums".into(),
    });
    Ok(())
}
