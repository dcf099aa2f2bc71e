//! Replay buffers compared with cpprb, and Parquet with pyarrow, measured by `benches/storage.py`.

use libration_report::record::{Cell, Record, Table};
use libration_study::{Lab, StudyError};

use crate::bench::{Peers, StoragePeer};
use crate::measurement::{Ratio, aim};
use crate::storage::StorageSettings;

/// Judges the ratios of the file that the configuration names, if it names one.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let Some(path) = &lab.config.get::<StorageSettings>().peers else { return Ok(()) };
    let peers = Peers::<StoragePeer>::read(path).map_err(StudyError::Exact)?;
    let columns = ["what", "peer", "threads", "its threads", "times as fast", "spread", "wanted"];
    let mut table = Table::new("peers", &columns);
    for row in &peers.rows {
        let [low, high] = row.quartiles;
        let text = format!("{}: over {} ({})", row.what, row.peer, peers.versions);
        let ratio = Ratio::new(row.ratio, high - low, peers.rounds as usize);
        let reason = "what another program takes is measured, and foretold by nobody";
        let id = format!("storage.{}.over-{}", row.what, row.peer.to_lowercase());
        aim(record, id, text, Some(row.wanted), ratio, reason);
        table.push([
            row.what.as_str().into(),
            row.peer.as_str().into(),
            row.threads[0].into(),
            row.threads[1].into(),
            row.ratio.into(),
            Cell::rounded(high - low, 2),
            row.wanted.into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use libration_study::{Config, Effort, Machine, Silent};
    use serde_json::json;

    use super::*;

    #[test]
    fn the_ratios_of_a_file_become_findings_and_a_table() {
        let row = |what: &str, peer: &str, ratio: f64, wanted: f64| {
            json!({
                "what": what, "peer": peer, "threads": [1, 1], "ratio": ratio,
                "quartiles": [ratio, ratio], "wanted": wanted,
            })
        };
        let file = json!({
            "schema": "libration.storage/1", "cpu": Machine::detect().cpu, "versions": "cpprb 11",
            "rounds": 5,
            "rows": [row("sample", "cpprb", 7.0, 5.0), row("parquet", "pyarrow", 1.2, 2.0)],
        });
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("storage.json");
        std::fs::write(&path, file.to_string()).expect("a file");
        let settings = StorageSettings { peers: Some(path), ..StorageSettings::default() };
        let config = Config::default().with(settings);
        let stop = AtomicBool::new(false);
        let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
        let mut record = Record::new("storage", "");
        measure(&lab, &mut record).expect("the file is there");
        let found = |id: &str| record.finding(id).expect("a finding for each row");
        assert_eq!(found("storage.sample.over-cpprb").measured, 7.0);
        assert_eq!(found("storage.parquet.over-pyarrow").measured, 1.2);
        assert!(!found("storage.parquet.over-pyarrow").agrees());
        assert_eq!(record.table("peers").expect("a table").rows.len(), 2);
    }
}
