//! Bytes of a transition with other float types and more fields.

use libration::rl::Plan;
use libration_report::record::{Cell, Finding, Record, Table};

use super::{ACTION, MIB, OBSERVATION};
use crate::source_rollouts::{EXAMPLES, LISTED};

/// Bytes of a number of each float type.
const FLOATS: [(&str, usize); 3] =
    [("f16", size_of::<u16>()), ("f32", size_of::<f32>()), ("f64", size_of::<f64>())];

/// Tells the bytes of every field, and of all of them.
pub(super) fn measure(record: &mut Record) {
    let [example, _] = EXAMPLES;
    let plain = Plan::new(example.horizon, example.environments);
    let full = plain.truncated().log_probabilities().values();
    let fields = |plan: Plan, size| plan.fields(OBSERVATION, ACTION, size);

    let mut table = Table::new("bytes of a transition", &["field", "f16", "f32", "f64"]);
    let by_float = FLOATS.map(|(_, size)| fields(full, size));
    for (i, (name, _)) in by_float[0].iter().enumerate() {
        let cells = by_float.iter().map(|fields| Cell::from(fields[i].1 as u64));
        table.push([Cell::from(name.replace('_', " "))].into_iter().chain(cells));
    }
    let mut sum = |what: &str, plan: Plan| {
        let bytes = FLOATS.map(|(_, size)| plan.bytes_each(OBSERVATION, ACTION, size));
        table.push([what.into()].into_iter().chain(bytes.map(|bytes| Cell::from(bytes as u64))));
        let mebibytes = FLOATS.map(|(_, size)| plan.bytes(OBSERVATION, ACTION, size) as f64 / MIB);
        let what = format!("{what}, {} (MiB)", example.title());
        table.push([what.into()].into_iter().chain(mebibytes.map(|x| Cell::rounded(x, 4))));
    };
    sum("up to terminated", plain);
    sum("all", full);
    record.tables.push(table);

    let listed = fields(plain, size_of::<f32>()).into_iter();
    let listed = listed.filter(|(name, _)| LISTED.contains(name)).map(|(_, bytes)| bytes);
    record.find(Finding::measured(
        "memory.listed",
        format!("f32, bytes of the fields that the source lists in §6.5: {}", LISTED.join(", ")),
        "B",
        listed.sum::<usize>() as f64,
    ));
    record.find(Finding::measured(
        "memory.each",
        "f32, bytes of a transition with its action",
        "B",
        plain.bytes_each(OBSERVATION, ACTION, size_of::<f32>()) as f64,
    ));
    let [half, single] = [0, 1].map(|i| {
        let (_, size) = FLOATS[i];
        plain.bytes_each(OBSERVATION, ACTION, size) as f64
    });
    record.find(Finding::measured(
        "memory.half",
        "bytes of a transition in f16 over those in f32; a flag stays a byte",
        "1",
        half / single,
    ));
}
