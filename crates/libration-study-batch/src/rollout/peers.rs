//! Rollouts of Libration compared with NumPy, numba, C and PufferLib, measured by `benches/rollouts.py`.

use libration_report::record::{Cell, Record, Table};
use libration_study::{Lab, StudyError};

use super::cases::on_cores;
use crate::bench::{Peers, RolloutPeer};
use crate::measurement::{Measurement, Ratio, aim};
use crate::rollout::RolloutSettings;

/// The file that the configuration names, if it names one.
pub(super) fn read(lab: &Lab<'_>) -> Result<Option<Peers<RolloutPeer>>, StudyError> {
    let path = lab.config.get::<RolloutSettings>().peers;
    path.map(|path| Peers::read(&path).map_err(StudyError::Exact)).transpose()
}

/// As identifiers name a ratio.
fn id(row: &RolloutPeer) -> String {
    let peer = row.peer.to_lowercase().replace(' ', "-");
    let horizon = row.horizon.map(|horizon| format!("x{horizon}")).unwrap_or_default();
    format!("rollout.{peer}-{}{horizon}", row.num_envs)
}

/// Judges the ratios of that file.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let Some(peers) = read(measurement.lab)? else { return Ok(()) };
    let columns =
        ["task", "environments", "horizon", "threads", "peer", "times as fast", "spread", "wanted"];
    let mut table = Table::new("peers", &columns);
    for row in &peers.rows {
        let [low, high] = row.quartiles;
        let text = format!(
            "{}, {} environments{}, {}: transitions a second over those of {} ({})",
            row.task,
            row.num_envs,
            row.horizon.map(|horizon| format!(", {horizon} steps")).unwrap_or_default(),
            on_cores(row.threads as usize),
            row.peer,
            peers.versions
        );
        let ratio = Ratio::new(row.ratio, high - low, peers.rounds as usize);
        let reason = "what another program takes is measured, and foretold by nobody";
        aim(record, id(row), text, Some(row.wanted), ratio, reason);
        table.push([
            row.task.as_str().into(),
            row.num_envs.into(),
            row.horizon.map_or_else(|| Cell::absent("any"), Cell::from),
            row.threads.into(),
            row.peer.as_str().into(),
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
    fn the_ratios_of_a_file_become_findings_and_a_rate_of_numpy_is_the_best_of_its_ways() {
        let row = |peer: &str, horizon: Option<u64>, ratio: f64, wanted: f64| {
            json!({
                "peer": peer, "task": "regulate", "num_envs": 256, "horizon": horizon,
                "threads": 2, "ratio": ratio, "quartiles": [ratio, ratio], "wanted": wanted,
            })
        };
        let rate = |name: &str, way: &str, rate: f64| {
            json!({
                "task": "regulate", "num_envs": 256, "horizon": 512, "name": name, "way": way,
                "transitions_per_second": rate,
            })
        };
        let file = json!({
            "schema": "libration.rollouts/2", "cpu": Machine::detect().cpu, "versions": "NumPy 2",
            "rounds": 5, "threads": 2, "absent": {},
            "rows": [row("numpy", Some(512), 50.0, 40.0), row("C loop", None, 1.0, 2.0)],
            "rates": [rate("numpy", "plain", 4e7), rate("numpy", "out=", 5e7), rate("numba", "split", 9e9)],
        });
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("rollouts.json");
        std::fs::write(&path, file.to_string()).expect("a file");
        let settings = RolloutSettings { peers: Some(path) };
        let config = Config::default().with(settings);
        let stop = AtomicBool::new(false);
        let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
        let measurement = Measurement::new(&lab).expect("this machine has its instruction set");
        let mut record = Record::new("rollout", "");
        measure(&measurement, &mut record).expect("the file is there");
        let found = |id: &str| record.finding(id).expect("a finding for each row");
        assert_eq!(found("rollout.numpy-256x512").measured, 50.0);
        let bar = (!cfg!(debug_assertions)).then_some(2.0);
        assert_eq!(found("rollout.c-loop-256").predicted, bar);
        let peers = read(&lab).expect("it is there").expect("it is named");
        assert_eq!(peers.best("numpy", 256, 512), Some(5e7));
        assert_eq!(peers.best("numpy", 256, 513), None);
    }
}
