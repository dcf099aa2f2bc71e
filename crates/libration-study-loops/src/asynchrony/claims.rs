//! The claims of the source report about clocks of different rates.

use libration_report::notation::number;
use libration_report::record::{Judgement, Record, Ruling};

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    let findings = [
        "asynchrony.gaussian.steps",
        "asynchrony.uniform.steps",
        "asynchrony.energy.largest",
        "asynchrony.stable.count",
        "asynchrony.stable.others",
        "asynchrony.replay.same-seed",
    ];
    let text = "Clocks of different rates let phases diverge and the ensemble lose consistency and \
                reproducibility, while each environment stays stable.";
    record.judge(Ruling { id: "C65a", source: "7.5", text, findings: &findings }, |f| {
        Judgement::conditional(format!(
            "phases diverge: at rates of 1 % the mean falls to 1/e in {} steps with Gaussian rates \
             and in {} with uniform ones. The energy of a trajectory changes by at most {} if its \
             step is below the limit; {} trajectories with z(1 + δ) above 2 grow without bound. \
             With a seed the run repeats bit for bit",
            number(f[0].measured, 4),
            number(f[1].measured, 4),
            number(f[2].measured, 2),
            number(f[3].measured, 4)
        ))
        .only("stable as long as z(1 + δ) < 2 for each clock; not reproducible where rates have no seed")
    });
    let findings = ["asynchrony.replay.same-seed", "asynchrony.replay.other-seed"];
    let text = "Jitter and asynchrony destroy reproducibility.";
    record.judge(Ruling { id: "C71", source: "8.4", text, findings: &findings }, |f| {
        Judgement::conditional(format!(
            "with the same seed {} of eight trajectories differ in any bit, for any number of \
             other trajectories; with another seed {} differ",
            number(f[0].measured, 1),
            number(f[1].measured, 1)
        ))
        .only("the noise has no seed, as that of real clocks")
    });
}
