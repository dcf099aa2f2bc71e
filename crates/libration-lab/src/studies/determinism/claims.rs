//! The claims of the source report about reproducibility.

use crate::notation::count;
use crate::record::{Finding, Judgement, Record, Ruling};

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
            "of {} trajectories none depends on the number of threads, since they share nothing; a sum over \
             them does, with {} different results of 4, unless its order is fixed, as it is in this \
             program’s means and variances",
            count(super::runs::COUNT as u64),
            times(f[2])
        ))
        .only("of sums over trajectories whose order is not fixed")
    });
    let ruling = Ruling {
        id: "C71",
        source: "8.4",
        text: "Jitter and asynchronous clocks destroy reproducibility.",
        findings: &[
            "determinism.kept.threads-shaken",
            "determinism.kept.count-shaken",
            "determinism.broken.seed",
        ],
    };
    record.judge(ruling, |f| {
        Judgement::conditional(format!(
            "noise that is drawn by address (seed, trajectory, step) is the same on any number of threads and in \
             an ensemble of any size, to the bit; with another seed {} trajectories of {} differ",
            times(f[2]),
            count(super::runs::COUNT as u64)
        ))
        .only("if noise has no seed, or depends on the order of drawing")
    });
}
