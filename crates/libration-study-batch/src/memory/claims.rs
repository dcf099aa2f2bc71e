//! Claims of §6.1, §6.5, §6.8 and §9.5 about memory.

use libration_report::notation::{count, number, seconds};
use libration_report::record::{Judgement, Record, Ruling};

use super::{MB, MIB};
use crate::source_rollouts::{BYTES, EXAMPLES};

/// Memory that is full within so many seconds is what a program meets first.
const SOON: f64 = 3600.0;

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    examples(record);
    growth(record);
    capacity(record);
}

/// The two examples of §6.5.
fn examples(record: &mut Record) {
    let [small, large] = EXAMPLES;
    let ids = [small, large].map(|case| format!("memory.{}.transitions", case.name()));
    let ids = ids.each_ref().map(String::as_str);
    let text = "4096 × 1024 are 4 194 304 transitions, and 16384 × 2048 are 33 554 432.";
    record.judge(Ruling { id: "C48", source: "6.1, 6.5", text, findings: &ids }, |f| {
        Judgement::confirmed(format!(
            "{} and {}",
            count(f[0].measured as u64),
            count(f[1].measured as u64)
        ))
    });
    let planned = [small, large].map(|case| format!("memory.{}", case.name()));
    let ids = [&planned[0], "memory.listed", "memory.each"];
    let text = "Two floats, a reward and a flag are about 16 bytes, and 4 194 304 of them 67 MB.";
    record.judge(Ruling { id: "C52", source: "6.5", text, findings: &ids }, |f| {
        let [planned, listed, each] = [0, 1, 2].map(|i| f[i].measured);
        let product = BYTES * small.transitions as f64 / MB;
        let because = format!(
            "16 bytes each are {} MB. But the fields of its list are {} bytes, and with the action that §6.3 \
             stores they are {}: {} MiB, which is the 68 “MB” that table 9.11 has for the same rollout",
            number(product, 3),
            number(listed, 2),
            number(each, 2),
            number(planned / MIB, 3)
        );
        match (product - small.megabytes).abs() < 0.5 {
            true => Judgement::conditional(because)
                .only("true of the product, not of the listed fields"),
            false => Judgement::refuted(because),
        }
    });
    let ids = [planned[1].as_str()];
    let text = "33 554 432 transitions are 544 MB.";
    record.judge(Ruling { id: "C53a", source: "6.5", text, findings: &ids }, |f| {
        let at_16 = BYTES * large.transitions as f64;
        let because = format!(
            "the 16 bytes of the text of the source give {} MB or {} MiB. The number {} follows \
             from {} bytes, in MiB; that is {} MB",
            number(at_16 / MB, 4),
            number(at_16 / MIB, 4),
            number(f[0].measured / MIB, 4),
            number(f[0].measured / large.transitions as f64, 3),
            number(f[0].measured / MB, 4)
        );
        Judgement::holds_if((at_16 / MB - large.megabytes).abs() < 0.5, because)
    });
}

/// Judges claims about the growth of memory.
fn growth(record: &mut Record) {
    let ids = ["memory.growth.environments", "memory.growth.horizon", "memory.growth.both"];
    let text = "Memory grows exponentially.";
    record.judge(Ruling { id: "C54", source: "6.5", text, findings: &ids }, |f| {
        Judgement::refuted(format!(
            "it is a product: it grows with the power {} of the number of environments and {} of \
             the horizon. If both double, it is {} times as large. §9.5 and §9.7 call it linear",
            number(f[0].measured, 3),
            number(f[1].measured, 3),
            number(f[2].measured, 3)
        ))
    });
    let text = "Memory is linear in environments and horizon.";
    record.judge(Ruling { id: "C90", source: "9.5, 9.7", text, findings: &ids }, |f| {
        Judgement::confirmed(format!(
            "powers {} and {}, to the byte; §6.5 calls the same growth exponential",
            number(f[0].measured, 3),
            number(f[1].measured, 3)
        ))
    });
}

/// Judges the claim about full memory.
fn capacity(record: &mut Record) {
    let ids = ["memory.rate", "memory.full"];
    let text =
        "Capacity of memory is the limit before arithmetic is, so that rollouts must be streamed.";
    record.judge(Ruling { id: "C57", source: "6.8", text, findings: &ids }, |f| {
        let because = format!(
            "at {}·10⁶ transitions a second the memory of this machine is full after {}",
            number(f[0].measured / 1e6, 3),
            seconds(f[1].measured, 2)
        );
        match f[1].measured < SOON {
            true => Judgement::conditional(because).only("everything is kept"),
            false => Judgement::refuted(because),
        }
    });
}
