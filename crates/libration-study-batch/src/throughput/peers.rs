//! Libration compared with NumPy and numba, measured by `benches/peers.py`.

use libration_report::notation::number;
use libration_report::record::{Finding, Record, Table, Undecided};
use libration_study::StudyError;

use crate::bench::{Peer, Peers};
use crate::measurement::{Measurement, Ratio, judge};
use crate::throughput::ThroughputSettings;

/// Judges the ratios of the file that the configuration names, if it names one.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let Some(path) = &measurement.lab.config.get::<ThroughputSettings>().peers else {
        return Ok(());
    };
    let peers = Peers::<Peer>::read(path).map_err(StudyError::Exact)?;
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
            row.dtype,
            (row.count as f64).log10()
        );
        let text = format!(
            "symplectic Euler, {}, N = {}: steps a second, {} over {} ({})",
            row.dtype,
            number(row.count as f64, 3),
            row.implementation,
            row.peer,
            peers.versions
        );
        if row.ratio < row.wanted && row.most < row.wanted {
            let most = number(row.most, 3);
            record.find(Finding::measured(id, text, "1", row.ratio).undecided(Undecided::Beyond(
                format!(
                    "beyond this machine, whose arithmetic goes to {most} times; wanted: {}",
                    row.wanted
                ),
            )));
        } else {
            let ratio = Ratio::new(row.ratio, high - low, peers.rounds as usize);
            judge(record, id, text, Some(row.wanted), ratio);
        }
        table.push([
            row.implementation.as_str().into(),
            row.peer.as_str().into(),
            row.dtype.as_str().into(),
            row.count.into(),
            row.ratio.into(),
            row.wanted.into(),
            row.most.into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use libration_study::{Config, Effort, Lab, Machine, Silent};
    use serde_json::json;

    use super::*;

    #[test]
    fn a_ratio_that_the_arithmetic_of_the_machine_does_not_allow_is_said_to_be_beyond_it() {
        let row = |count: u64, ratio: f64, most: f64| {
            json!({
                "implementation": "fused", "peer": "numpy in place", "dtype": "f32", "count": count,
                "ratio": ratio, "quartiles": [ratio, ratio], "wanted": 80.0, "most": most,
            })
        };
        let file = json!({
            "schema": "libration.peers/2", "cpu": Machine::detect().cpu, "versions": "NumPy 2",
            "rounds": 5, "rows": [row(1_000, 54.0, 59.0), row(100_000, 54.0, 90.0)],
        });
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("peers.json");
        std::fs::write(&path, file.to_string()).expect("a file");
        let settings = ThroughputSettings { peers: Some(path), ..ThroughputSettings::default() };
        let config = Config::default().with(settings);
        let stop = AtomicBool::new(false);
        let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
        let measurement = Measurement::new(&lab).expect("this machine has its instruction set");
        let mut record = Record::new("throughput", "");
        measure(&measurement, &mut record).expect("the file is there");
        let found = |count| {
            let id = format!("throughput.fused-over-numpy-in-place.f32.1e{count}");
            record.finding(&id).expect("a finding for each row").clone()
        };
        let reason = found(3).undecided.expect("59 is less than 80").to_string();
        assert!(reason.contains("goes to 59 times; wanted: 80"), "{reason}");
        // In a build for speed it is missed.
        let bar = (!cfg!(debug_assertions)).then_some(80.0);
        assert_eq!((found(5).predicted, found(5).undecided), (bar, None));
        assert_eq!(record.table("peers").expect("its table").rows.len(), 2);
    }
}
