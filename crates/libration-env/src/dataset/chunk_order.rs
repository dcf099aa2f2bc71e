//! The order of the chunks in a manifest.

use libration_data::Chunk;

/// The first chunk of a manifest in the wrong place, in words; none if the chunks are the first ones of the groups in order.
/// Each group has `chunks` chunks.
pub(super) fn find_misplaced(
    all: &[Chunk],
    [first, end]: [usize; 2],
    chunks: u64,
) -> Option<String> {
    let wanted = |i: usize| {
        let (group, k) = (first as u64 + i as u64 / chunks, i as u64 % chunks);
        (group < end as u64).then(|| format!("{group:06}-{k:08}"))
    };
    let i = (0..all.len()).find(|&i| wanted(i).as_ref() != Some(&all[i].chunk))?;
    let place = wanted(i).map_or_else(
        || "after the last chunk".to_owned(),
        |wanted| format!("in the place of {wanted}"),
    );
    // The first line has the settings.
    let (found, line) = (&all[i].chunk, i + 2);
    let help = format!("delete line {line} and all lines after it, then run with --resume");
    Some(format!("chunk {found} is {place}; help: {help}"))
}
