//! Rates of rollouts, as text and as JSON.

use libration::rl::{Layout, Writes};
use libration_study::Machine;
use libration_study_batch::bench::RolloutRate;
use serde_json::{Value, json};

use super::{SCHEMA, columns};

fn layout(rate: &RolloutRate) -> &'static str {
    match rate.layout {
        Layout::Interleaved => "interleaved",
        Layout::Planes => "planes",
    }
}

fn writes(rate: &RolloutRate) -> &'static str {
    way(rate.writes)
}

fn way(writes: Writes) -> &'static str {
    match writes {
        Writes::Plain => "plain",
        Writes::Past => "non-temporal",
    }
}

pub(super) fn json(rates: &[RolloutRate]) -> String {
    let rate = |rate: &RolloutRate| -> Value {
        json!({
            "task": rate.case.task.name(),
            "num_envs": rate.case.environments,
            "horizon": rate.case.horizon,
            "bytes": rate.case.bytes(),
            "layout": layout(rate),
            "writes": writes(rate),
            "threads": rate.threads,
            "transitions_per_second": rate.median,
            "spread": rate.spread,
            "fill": way(rate.case.against()),
            "share_of_fill": rate.share,
            "share_spread": rate.share_spread,
        })
    };
    let rates: Vec<Value> = rates.iter().map(rate).collect();
    format!("{:#}\n", json!({ "schema": SCHEMA, "machine": Machine::detect(), "rollouts": rates }))
}

pub(super) fn text(rates: &[RolloutRate]) -> String {
    let head = [
        "task",
        "environments",
        "horizon",
        "MiB",
        "layout",
        "stores",
        "threads",
        "10⁹ transitions/s",
        "spread",
        "of a fill",
        "spread",
    ];
    let row = |rate: &RolloutRate| {
        let case = rate.case;
        vec![
            case.task.name().to_owned(),
            case.environments.to_string(),
            case.horizon.to_string(),
            format!("{:.2}", case.bytes() as f64 / f64::from(1 << 20)),
            layout(rate).to_owned(),
            writes(rate).to_owned(),
            rate.threads.to_string(),
            format!("{:.3}", rate.median / 1e9),
            format!("{:.3}", rate.spread / 1e9),
            format!("{:.2}", rate.share),
            format!("{:.2}", rate.share_spread),
        ]
    };
    let head = vec![head.map(String::from).to_vec()];
    columns(&head.into_iter().chain(rates.iter().map(row)).collect::<Vec<_>>())
}
