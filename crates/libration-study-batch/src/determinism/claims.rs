//! The claims of the source report about reproducibility.

use libration_report::notation::count;
use libration_report::record::{Finding, Judgement, Record, Ruling};

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    let times = |f: &Finding| count(f.measured as u64);
    let ruling = Ruling {
        id: "C66",
        source: "7.6",
        text: "Order of parallel execution, and addition that is not associative, break determinism.",
        findings: &[
            "determinism.kept.threads",
            "determinism.kept.moments",
            "determinism.broken.sum",
            "determinism.broken.association",
        ],
    };
    record.judge(ruling, |f| {
        Judgement::conditional(format!(
            "none of {} trajectories depends on the number of threads, since they share nothing. A \
             sum over them depends on it ({} different results of 4), unless its order is fixed, \
             as for the means and variances of this program",
            count(super::runs::COUNT as u64),
            times(f[2])
        ))
        .only("of sums over trajectories whose order is not fixed")
    });
}
