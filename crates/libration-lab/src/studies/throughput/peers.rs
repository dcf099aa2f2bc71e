//! Libration beside NumPy and numba, as another program measured them.

use super::desk::{Desk, Ratio, judge};
use crate::bench::Peers;
use crate::notation::number;
use crate::record::{Finding, Record, Table};
use crate::study::StudyError;

/// Judges the ratios of the file that the configuration names, if it names one.
pub(super) fn measure(desk: &Desk<'_>, record: &mut Record) -> Result<(), StudyError> {
    let Some(path) = &desk.lab.config.throughput.peers else { return Ok(()) };
    let peers = Peers::read(path).map_err(StudyError::Exact)?;
    let mut table = Table::new(
        "peers",
        &[
            "implementation",
            "peer",
            "float",
            "trajectories",
            "times as fast",
            "wanted",
            "arithmetic",
        ],
    );
    for row in &peers.rows {
        let [low, high] = row.quartiles;
        let id = format!(
            "throughput.{}-over-{}.{}.1e{}",
            row.implementation,
            row.peer.replace([' ', '='], "-"),
            row.float,
            (row.count as f64).log10()
        );
        let text = format!(
            "symplectic Euler, {}, N = {}: steps a second, {} over {} ({})",
            row.float,
            number(row.count as f64, 3),
            row.implementation,
            row.peer,
            peers.versions
        );
        if row.ratio < row.wanted && row.most < row.wanted {
            let most = number(row.most, 3);
            record.find(Finding::measured(id, text, "1", row.ratio).undecided(format!(
                "beyond this machine, whose arithmetic goes to {most} times; wanted: {}",
                row.wanted
            )));
        } else {
            let ratio = Ratio::new(row.ratio, high - low, peers.rounds as usize);
            judge(record, id, text, Some(row.wanted), ratio);
        }
        table.push([
            row.implementation.as_str().into(),
            row.peer.as_str().into(),
            row.float.as_str().into(),
            row.count.into(),
            row.ratio.into(),
            row.wanted.into(),
            row.most.into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}
