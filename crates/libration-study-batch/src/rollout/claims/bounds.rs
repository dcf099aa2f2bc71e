//! Claims about the limits of rollouts.

use libration_report::notation::number;
use libration_report::record::{Judgement, Record, Ruling};

use super::show;
use crate::source_rollouts::{EXAMPLES, SATURATED};

/// Least share of a fill for a rollout that is limited by memory.
const BOUND: f64 = 0.5;

/// Judges them.
pub(super) fn judge(record: &mut Record) {
    let [example, _] = EXAMPLES;
    let own = format!("rollout.{}", example.name());
    let ids = ["rollout.source.bandwidth", &own];
    let source = |bandwidth: f64| {
        format!(
            "the fastest row of its table writes {} GB/s, {} % of the {SATURATED} GB/s at which §9.4 has the memory \
             saturated",
            show(bandwidth),
            number(100.0 * bandwidth / SATURATED, 2)
        )
    };
    let text = "The rate of rollouts scales with the bandwidth of the memory.";
    record.judge(Ruling { id: "C56", source: "6.7", text, findings: &ids }, |f| {
        let (bandwidth, share) = (f[0].measured, f[1].measured);
        let because = format!(
            "{}: what it waits for is something else. A fused rollout of {} reaches {} % of a fill of as much \
             memory here",
            source(bandwidth),
            example.title(),
            number(100.0 * share, 2)
        );
        match share > BOUND {
            true => Judgement::conditional(because).only("steps are fused; not of the source’s own"),
            false => Judgement::refuted(because),
        }
    });
    let ids = ["rollout.source.fall", "rollout.source.bandwidth", "rollout.step.fall"];
    let text = "From small to large rollouts a transition from compute-bound to memory-bound was observed.";
    record.judge(Ruling { id: "C91", source: "9.5", text, findings: &ids }, |f| {
        let [fall, bandwidth, own] = [0, 1, 2].map(|i| f[i].measured);
        let because = format!(
            "a wall of memory would make transitions slower. Through its table they become {} times as fast: the cost of a \
             step is shared by more environments (from the fewest to the most, {} times as fast here); and {}",
            show(fall),
            show(own),
            source(bandwidth)
        );
        Judgement::holds_if(fall < 1.0, because)
    });
    let ids = ["rollout.source.bandwidth", &own];
    let text = "Bandwidth of memory is the main bottleneck of large simulations.";
    record.judge(Ruling { id: "C96", source: "10", text, findings: &ids }, |f| {
        let (bandwidth, share) = (f[0].measured, f[1].measured);
        let percent = number(100.0 * share, 2);
        let nobody = "Steps whose results nobody keeps wait for no memory, as the chapter on throughput shows";
        match share > BOUND {
            true => Judgement::conditional(format!(
                "{}. It does limit a fused rollout of {}, which reaches {percent} % of a fill. {nobody}",
                source(bandwidth),
                example.title()
            ))
            .only("every step is stored and nothing else costs; not of the source’s own"),
            false => Judgement::refuted(format!(
                "{}. A fused rollout of {} reaches no more than {percent} % of a fill. {nobody}",
                source(bandwidth),
                example.title()
            )),
        }
    });
}
