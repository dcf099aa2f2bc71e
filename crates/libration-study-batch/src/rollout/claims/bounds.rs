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
            "the fastest row of the source’s table writes {} GB/s, {} % of the {SATURATED} GB/s at \
             which §9.4 calls the memory saturated",
            show(bandwidth),
            number(100.0 * bandwidth / SATURATED, 2)
        )
    };
    let text = "The rate of rollouts scales with the bandwidth of the memory.";
    record.judge(Ruling { id: "C56", source: "6.7", text, findings: &ids }, |f| {
        let (bandwidth, share) = (f[0].measured, f[1].measured);
        let because = format!(
            "{}: something else limits it. A fused rollout of {} reaches {} % of a fill of as much \
             memory here",
            source(bandwidth),
            example.title(),
            number(100.0 * share, 2)
        );
        match share > BOUND {
            true => Judgement::conditional(because)
                .only("steps are fused; not for the rollouts of the source"),
            false => Judgement::refuted(because),
        }
    });
    let ids = ["rollout.source.fall", "rollout.source.bandwidth", "rollout.step.fall"];
    let text = "From small to large rollouts a transition from compute-bound to memory-bound was observed.";
    record.judge(Ruling { id: "C91", source: "9.5", text, findings: &ids }, |f| {
        let [fall, bandwidth, own] = [0, 1, 2].map(|i| f[i].measured);
        let because = format!(
            "a limit of memory would make transitions slower. From the first to the last row of \
             its table they become {} times as fast, since more environments share the cost of a \
             step (here {} times, from the fewest to the most environments); and {}",
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
        let nobody = "Steps without stored results do not wait for memory (chapter on throughput)";
        match share > BOUND {
            true => Judgement::conditional(format!(
                "{}. It does limit a fused rollout of {}, which reaches {percent} % of a fill. {nobody}",
                source(bandwidth),
                example.title()
            ))
            .only("every step is stored and nothing else is slow; not for rollouts of the source"),
            false => Judgement::refuted(format!(
                "{}. A fused rollout of {} reaches no more than {percent} % of a fill. {nobody}",
                source(bandwidth),
                example.title()
            )),
        }
    });
}
