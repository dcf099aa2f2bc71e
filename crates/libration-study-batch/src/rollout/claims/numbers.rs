//! Claims that are numbers of the source.

use libration_report::notation::{count, number};
use libration_report::record::{Judgement, Record, Ruling};

use super::show;
use crate::rollout::source_table::example_times;
use crate::source_rollouts::{EXAMPLES, PEAK_MILLIONS, Row, TABLE};

/// Times that lie further than this from a line are of no line.
const SMOOTH: f64 = 0.1;

/// Judges them.
pub(super) fn judge(record: &mut Record) {
    example(record);
    let ids = ["rollout.source.most"];
    let text = "The peak is about 70 million transitions a second.";
    record.judge(Ruling { id: "C84", source: "9.5", text, findings: &ids }, |f| {
        let most = f[0].measured;
        let because = format!(
            "table 9.11, on the same page, has {} million in its last row",
            number(most, 4)
        );
        Judgement::holds_if((most - PEAK_MILLIONS).abs() < 5.0, because)
    });
    for (row, id) in TABLE.iter().zip(["C85", "C86", "C87", "C88"]) {
        self::row(record, row, id);
    }
    let ids = ["rollout.source.residual", "rollout.source.overhead"];
    let text = "The times of table 9.11 are what a step costs, and what each environment adds.";
    record.judge(Ruling { id: "C89", source: "9.11", text, findings: &ids }, |f| {
        let steps = TABLE.map(|row| number(1e6 * row.step(), 3)).join(", ");
        let off = number(100.0 * f[0].measured, 2);
        let because = format!(
            "{steps} µs per step for {} environments do not lie on a line a + b·N: one is {off} % \
             off the best line. They are single measurements without repetition",
            TABLE.map(|row| row.of.environments.to_string()).join(", ")
        );
        Judgement::holds_if(f[0].measured < SMOOTH, because)
    });
}

/// Time and rate of §6.7.
fn example(record: &mut Record) {
    let [example, _] = EXAMPLES;
    let own = format!("rollout.rate.{}", example.name());
    let ids = ["rollout.source.example", "rollout.source.twice", "rollout.source.most", &own];
    let text = "4096 × 1024 transitions take about 0.09 s, which is about 44 million a second.";
    record.judge(Ruling { id: "C55", source: "6.7", text, findings: &ids }, |f| {
        let [shortest, longest] = example_times();
        let because = format!(
            "0.09 s correspond to {} million per second; both rounded numbers fit one run only if \
             it took {} to {} s. In table 9.11 the same rollout is {} times as fast, at {} \
             million; §9.5 gives a peak between the two. Here one core reaches {} million",
            show(f[0].predicted.unwrap_or(f64::NAN)),
            number(shortest, 3),
            number(longest, 3),
            number(f[1].measured, 2),
            number(f[2].measured, 4),
            show(f[3].measured / 1e6)
        );
        match shortest <= longest {
            true => Judgement::conditional(because).only("table 9.11 is of another run"),
            false => Judgement::refuted(because),
        }
    });
}

/// One row of table 9.11.
fn row(record: &mut Record, row: &Row, id: &str) {
    let name = row.of.name();
    let ids = ["transitions", "memory", "rate"].map(|what| format!("rollout.source.{name}.{what}"));
    let own = ["", ".threads"].map(|on| format!("rollout.rate.{name}{on}"));
    let ids: Vec<&str> = ids.iter().chain(&own).map(String::as_str).collect();
    // A machine of one core has no rate of all.
    let ids: Vec<&str> = ids.into_iter().filter(|id| record.finding(id).is_ok()).collect();
    let text = format!(
        "{}: {} transitions, {} MB, {} s, {} million a second.",
        row.of.title(),
        count(row.of.transitions),
        row.of.megabytes,
        row.seconds,
        row.millions
    );
    record.judge(Ruling { id, source: "9.11", text: &text, findings: &ids }, |f| {
        let own: Vec<String> = f[3..].iter().map(|f| show(f.measured / 1e6)).collect();
        let because = format!(
            "the row is consistent if its MB are MiB and a transition has 17 bytes. Here: {} \
             million per second",
            own.join(" on one core, and on all ")
        );
        Judgement::confirmed(because)
    });
}
