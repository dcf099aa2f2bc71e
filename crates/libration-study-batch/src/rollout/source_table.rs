//! Consistency of the numbers of the source about rollouts.

use libration::rl::Plan;
use libration_report::record::{Cell, Finding, Record, Table, Tolerance};

use super::affine_cost::Line;
use crate::source_rollouts::{BYTES, EXAMPLE_MILLIONS, EXAMPLE_SECONDS, EXAMPLES, Row, TABLE};

/// Bytes of a MB in the source.
const MIB: f64 = (1 << 20) as f64;

/// Bytes of a transition in table 9.11, by its own column.
fn bytes_each(row: &Row) -> f64 {
    (row.of.megabytes * MIB / row.of.transitions as f64).round()
}

/// Time of a step of all environments in table 9.11, as a line through its rows.
pub(super) fn line() -> Line {
    let environments = TABLE.map(|row| row.of.environments as f64);
    Line::through(&environments, &TABLE.map(|row| row.step()))
}

/// Checks each row by itself, and what all of them say of a step.
pub(super) fn check(record: &mut Record) {
    let line = line();
    let columns = [
        "environments",
        "horizon",
        "a step (µs)",
        "a + b·N (µs)",
        "off by (%)",
        "a transition (ns)",
        "written (GB/s)",
    ];
    let mut table = Table::new("steps of table 9.11", &columns);
    for row in &TABLE {
        consistent(record, row);
        let environments = row.of.environments as f64;
        table.push([
            (row.of.environments as u64).into(),
            (row.of.horizon as u64).into(),
            (1e6 * row.step()).into(),
            (1e6 * line.at(environments)).into(),
            Cell::rounded(100.0 * line.residual(environments, row.step()), 2),
            (1e9 * row.each()).into(),
            (bytes_each(row) / row.each() / 1e9).into(),
        ]);
    }
    record.tables.push(table);
    let off = TABLE.map(|row| line.residual(row.of.environments as f64, row.step()).abs());
    let [first, .., last] = TABLE;
    let most = TABLE.map(|row| row.millions).into_iter().fold(0.0, f64::max);
    for (id, text, unit, value) in [
        ("overhead", "a of a + b·N through the times of a step in table 9.11", "s", line.fixed),
        (
            "share",
            "the part of a in the time of a step of the fewest environments of table 9.11",
            "1",
            line.fixed / first.step(),
        ),
        (
            "residual",
            "how far the time of a step in table 9.11 lies from a + b·N at most, as a share of it",
            "1",
            off.into_iter().fold(0.0, f64::max),
        ),
        (
            "fall",
            "time of a transition in the first row of table 9.11 over that in the last",
            "1",
            first.each() / last.each(),
        ),
        ("most", "the most transitions a second in table 9.11, in millions", "1", most),
        (
            "bandwidth",
            "what the last row of table 9.11 writes, by its own memory and time",
            "GB/s",
            bytes_each(&last) / last.each() / 1e9,
        ),
    ] {
        record.find(Finding::measured(format!("rollout.source.{id}"), text, unit, value));
    }
    let [example, _] = EXAMPLES;
    // A rate that is printed with two digits, of a time that is printed with one.
    let rate = example.transitions as f64 / EXAMPLE_SECONDS / 1e6;
    record.find(Finding::predicted(
        "rollout.source.example",
        "the rate that §6.7 prints, in millions a second, beside transitions over its time",
        "1",
        rate,
        EXAMPLE_MILLIONS,
        Tolerance::absolute(
            rate * HALF / (EXAMPLE_SECONDS - HALF) + 0.5,
            "half a unit of the last digit of each: the time has one digit, the rate two",
        ),
    ));
    record.find(Finding::measured(
        "rollout.source.twice",
        "time of 4096 × 1024 transitions in §6.7 over that in table 9.11",
        "1",
        EXAMPLE_SECONDS / last.seconds,
    ));
    record.find(Finding::measured(
        "rollout.source.listed",
        "what §6.7 writes by the 16 bytes of §6.5",
        "GB/s",
        BYTES * example.transitions as f64 / EXAMPLE_SECONDS / 1e9,
    ));
}

/// Half a unit of the last digit of the time in §6.7, in s.
const HALF: f64 = 0.005;

/// The shortest and the longest time that round to what §6.7 prints, and give its rate.
pub(super) fn example_times() -> [f64; 2] {
    let [example, _] = EXAMPLES;
    let at = |millions: f64| example.transitions as f64 / (1e6 * millions);
    [
        at(EXAMPLE_MILLIONS + 0.5).max(EXAMPLE_SECONDS - HALF),
        at(EXAMPLE_MILLIONS - 0.5).min(EXAMPLE_SECONDS + HALF),
    ]
}

/// Whether a row of table 9.11 agrees with itself.
fn consistent(record: &mut Record, row: &Row) {
    let Row { of, seconds, millions } = *row;
    let (name, title) = (of.name(), of.title());
    record.find(Finding::predicted(
        format!("rollout.source.{name}.transitions"),
        format!("transitions of {title} in table 9.11, beside the product"),
        "1",
        (of.environments * of.horizon) as f64,
        of.transitions as f64,
        Tolerance::exact("whole numbers"),
    ));
    let plan = Plan::new(of.horizon, of.environments);
    record.find(Finding::predicted(
        format!("rollout.source.{name}.memory"),
        format!(
            "memory of {title} in table 9.11, which says MB, beside 17 bytes for each transition"
        ),
        "MiB",
        plan.bytes(2, 1, size_of::<f32>()) as f64 / MIB,
        of.megabytes,
        Tolerance::absolute(0.5e-2, "half a unit of the last of two decimals"),
    ));
    let rate = of.transitions as f64 / seconds / 1e6;
    record.find(Finding::predicted(
        format!("rollout.source.{name}.rate"),
        format!("millions of transitions a second of {title} in table 9.11, beside transitions over time"),
        "1",
        rate,
        millions,
        Tolerance::absolute(
            rate * 0.5e-4 / seconds + 0.5e-2,
            "half a unit of the last digit of the time and of the rate, which have four and two decimals",
        ),
    ));
}

#[cfg(test)]
mod tests {
    use libration_report::record::Agreement;

    use super::*;

    #[test]
    fn the_rows_of_the_source_agree_with_themselves_and_are_no_line() {
        let mut record = Record::new("rollout", "?");
        check(&mut record);
        assert!(record.findings.iter().all(|f| f.verdict != Agreement::Disagrees));
        let found = |id: &str| record.finding(&format!("rollout.source.{id}")).map(|f| f.measured);
        assert_eq!(found("most"), Ok(90.44));
        // 44.2 ns and 11.1 ns; 17 bytes in 11.06 ns.
        assert!(found("fall").is_ok_and(|fall| (fall - 4.0).abs() < 0.01));
        assert!(found("bandwidth").is_ok_and(|rate| (rate - 1.537).abs() < 0.001));
        assert!(found("residual").is_ok_and(|off| (off - 0.349).abs() < 0.001));
        let [shortest, longest] = example_times();
        assert!((shortest - 0.09425).abs() < 1e-5 && longest == 0.095, "{shortest} {longest}");
    }
}
