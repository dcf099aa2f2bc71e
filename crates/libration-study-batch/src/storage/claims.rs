//! The claim of §6.4 about replay buffers.

use libration_report::notation::number;
use libration_report::record::{Finding, Judgement, Record, Ruling};

/// Judges it from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    let ids = [
        "storage.circle.new",
        "storage.circle.old",
        "storage.circle.bytes",
        "storage.odds.uniform",
        "storage.bytes",
    ];
    let text = "A replay buffer is circular, of fixed capacity, and sampled in batches; its memory is of the order \
                of its capacity times the dimension.";
    record.judge(Ruling { id: "C51", source: "6.4", text, findings: &ids }, |f| {
        let because = format!(
            "a buffer that was filled three times over holds the newest {} transitions and {} older ones, has grown by {} \
             bytes, draws each as often as any other (χ²/k = {}), and takes {} bytes for a transition: the next \
             observation is the next row",
            number(f[0].measured, 4),
            number(f[1].measured, 1),
            number(f[2].measured, 1),
            number(f[3].measured, 3),
            number(f[4].measured, 3)
        );
        if f.iter().all(|finding: &&Finding| finding.agrees()) {
            Judgement::conditional(because).only("as a design: the source gives no measurement")
        } else {
            Judgement::refuted(because)
        }
    });
}
