//! Rates of replay buffers, data sets and checkpoints, as text and as JSON.

use libration_study::Machine;
use libration_study_batch::bench::StorageRate;
use serde_json::{Value, json};

use super::{SCHEMA, columns};

pub(super) fn json(rates: &[StorageRate]) -> String {
    let rate = |rate: &StorageRate| -> Value {
        json!({
            "what": rate.stored.name(),
            "threads": rate.threads,
            "unit": rate.stored.unit(),
            "rate": rate.median,
            "spread": rate.spread,
            "against": rate.stored.against(),
            "share": rate.share.map(|[share, _]| share),
            "share_spread": rate.share.map(|[_, spread]| spread),
        })
    };
    let rates: Vec<Value> = rates.iter().map(rate).collect();
    format!("{:#}\n", json!({ "schema": SCHEMA, "machine": Machine::detect(), "storage": rates }))
}

pub(super) fn text(rates: &[StorageRate]) -> String {
    let head = ["what", "threads", "10⁶/s", "spread", "of", "share of", "which is", "spread"];
    let row = |rate: &StorageRate| {
        let digits = |x: f64| format!("{x:.3}");
        let [share, spread] = rate.share.map_or_else(Default::default, |pair| pair.map(digits));
        vec![
            rate.stored.name().to_owned(),
            rate.threads.to_string(),
            digits(rate.median / 1e6),
            digits(rate.spread / 1e6),
            rate.stored.unit().trim_end_matches("/s").to_owned(),
            rate.stored.against().unwrap_or_default().to_owned(),
            share,
            spread,
        ]
    };
    let head = vec![head.map(String::from).to_vec()];
    columns(&head.into_iter().chain(rates.iter().map(row)).collect::<Vec<_>>())
}
