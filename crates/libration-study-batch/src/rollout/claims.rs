//! Claims of chapter 6, of §9.5 and of chapter 10 about rollouts.

mod bounds;
mod numbers;

use libration_report::notation::{count, list, number};
use libration_report::record::{Agreement, Finding, Judgement, Record, Ruling};

use crate::source_rollouts::EXAMPLES;

/// A rate that is tens of millions.
const TENS_OF_MILLIONS: f64 = 1e7;

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    design(record);
    bits(record);
    numbers::judge(record);
    bounds::judge(record);
}

fn show(x: f64) -> String {
    number(x, 3)
}

/// Judges claims about steps and storage of a batch.
fn design(record: &mut Record) {
    let ids = ["rollout.source.overhead", "rollout.source.share", "rollout.step.least"];
    let text = "A batched environment needs no loop in Python at all.";
    record.judge(Ruling { id: "C49", source: "6.2", text, findings: &ids }, |f| {
        let because = format!(
            "the loop over the steps remains. By the table of the source it costs {} µs per step \
             for any number of environments, {} % of a step of the smallest batch; here a step of \
             the smallest batch takes {} µs",
            show(1e6 * f[0].measured),
            number(100.0 * f[1].measured, 2),
            show(1e6 * f[2].measured)
        );
        Judgement::holds_if(f[1].measured < 0.05, because)
    });
    let [example, _] = EXAMPLES;
    let planes = format!("rollout.planes.{}", example.name());
    let ids = ["rollout.stride.interleaved", "rollout.stride.planes", &planes];
    let text = "`states[t, n, :]` is a structure of arrays, contiguous in memory.";
    record.judge(Ruling { id: "C50", source: "6.3, 8.5", text, findings: &ids }, |f| {
        let [interleaved, planes, gain] = [0, 1, 2].map(|i| f[i].measured);
        let because = format!(
            "it is an array of structures: the next position is {} bytes away, since a velocity \
             lies between them; in planes it is {} bytes away. Planes are written at {} % of the \
             rate of interleaved components (one core, {})",
            show(interleaved),
            show(planes),
            show(100.0 * gain),
            example.title()
        );
        Judgement::holds_if(interleaved == planes, because)
    });
}

/// Judges the claim about the reproducibility of rollouts.
fn bits(record: &mut Record) {
    let kept: Vec<String> =
        record.findings.iter().map(|f| f.id.clone()).filter(|id| id.contains(".kept.")).collect();
    let mut ids: Vec<&str> = kept.iter().map(String::as_str).collect();
    let changed = |f: &[&Finding]| {
        let names: Vec<&str> = f.iter().filter_map(|f| f.id.rsplit('.').next()).collect();
        (list(&names), f.iter().all(|f| f.verdict == Agreement::Agrees))
    };
    let text = "Rollouts are deterministic.";
    record.judge(Ruling { id: "C58", source: "6.6, 9.5", text, findings: &ids }, |f| {
        let (names, all) = changed(f);
        let because = format!(
            "every bit is reproducible with latencies, jitter, noise and random springs, also on \
             many threads, which the source does not test ({names})"
        );
        Judgement::holds_if(all, because)
    });
    let [example, _] = EXAMPLES;
    let rate = format!("rollout.rate.{}", example.name());
    ids.push(&rate);
    let text = "A CPU makes tens of millions of transitions a second, deterministically.";
    record.judge(Ruling { id: "C95", source: "10", text, findings: &ids }, |f| {
        let Some((rate, kept)) = f.split_last() else { return Judgement::refuted("") };
        let because = format!(
            "{} a second on one core at {}, with the same bits in every variant",
            count((rate.measured / 1e6).round() as u64 * 1_000_000),
            example.title()
        );
        Judgement::holds_if(rate.measured > TENS_OF_MILLIONS && changed(kept).1, because)
    });
}
