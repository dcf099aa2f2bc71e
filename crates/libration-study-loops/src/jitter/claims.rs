//! The claims of the source report about jitter.

use libration_report::notation::{count, number};
use libration_report::record::{Finding, Judgement, Record, Ruling};

/// Settings far on either side of `1/γ`.
const STILL: [&str; 2] = [
    "jitter.symplectic-euler.dt-0.001.rms-0.1.bounded",
    "jitter.velocity-verlet.dt-0.001.rms-0.1.bounded",
];
const GROWN: [&str; 2] =
    ["jitter.symplectic-euler.dt-0.3.rms-0.1.mean", "jitter.velocity-verlet.dt-0.3.rms-0.1.mean"];
const COMMUTES: [&str; 2] =
    ["jitter.rk4.dt-0.1.rms-0.1.deviation", "jitter.symplectic-euler.dt-0.1.rms-0.1.deviation"];
const PHASES: [&str; 4] = [
    "jitter.velocity-verlet.dt-0.001.rms-0.1.phase-nominal",
    "jitter.velocity-verlet.dt-0.01.rms-0.01.phase-nominal",
    "jitter.velocity-verlet.dt-0.001.rms-0.1.phase-elapsed",
    "jitter.velocity-verlet.dt-0.01.rms-0.01.phase-elapsed",
];

/// Growth of `ln E` beyond which nobody calls an energy bounded.
const EXPLODED: f64 = 1.0;

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record, steps: u64) {
    energy(record, steps);
    phase(record);
    let findings = ["jitter.replay.same-seed", "jitter.replay.other-seed"];
    let text = "Under jitter the deterministic trajectory is no longer preserved.";
    record.judge(Ruling { id: "C65", source: "7.4", text, findings: &findings }, |f| {
        Judgement::conditional(format!(
            "only if the seed is lost: with the same seed {} of eight trajectories differ in any \
             bit, with another seed {} of eight",
            number(f[0].measured, 1),
            number(f[1].measured, 1)
        ))
        .only("the noise has no seed, as that of a real clock")
    });
}

/// Whether the runs that should explode do so here: with other springs they may be too short.
fn explodes(record: &Record) -> bool {
    GROWN.iter().all(|id| record.finding(id).is_ok_and(|f| f.measured > EXPLODED))
}

fn evidence(f: &[&Finding], steps: &str) -> String {
    format!(
        "ln E performs a random walk with mean 2γN and standard deviation 2√(γN), where γ = σ²z⁴/8 \
         for symplectic Euler and σ²z⁶/32 for velocity Verlet. At Δt = 1 ms and σ = 10 % ln E \
         stays within {} and {} over {steps} steps, at 0.3 s it has grown by {} and {}",
        number(f[0].measured, 2),
        number(f[1].measured, 2),
        number(f[2].measured, 3),
        number(f[3].measured, 3)
    )
}

fn energy(record: &mut Record, steps: u64) {
    if !explodes(record) {
        return;
    }
    let steps = count(steps);
    let short = format!("the number of steps is far below 1/γ, e.g. {steps} at Δt = 1 ms");
    let findings = [&STILL[..], &GROWN[..], &COMMUTES[..]].concat();
    let text = "Under jitter energy remains bounded with symplectic methods.";
    record.judge(Ruling { id: "C60", source: "7.4", text, findings: &findings }, |f| {
        Judgement::conditional(format!(
            "{}. Steps of different lengths preserve different ellipses, and each change of the \
             ellipse changes the energy. Steps of RK4 are functions of one matrix and commute: at \
             Δt = 0.1 s and σ = 10 % the deviation of ln E is {} with RK4, and {} with symplectic \
             Euler",
            evidence(f, &steps),
            number(f[4].measured, 2),
            number(f[5].measured, 2)
        ))
        .only(&short)
    });
    let findings = [&STILL[..], &GROWN[..], &PHASES[..2]].concat();
    let text = "Over a long horizon jitter induces phase drift, not an explosion of energy.";
    record.judge(Ruling { id: "C93", source: "9.6", text, findings: &findings }, |f| {
        Judgement::conditional(format!(
            "{}; phases deviate by {} and {} rad",
            evidence(f, &steps),
            number(f[4].measured, 2),
            number(f[5].measured, 2)
        ))
        .only(&short)
    });
}

fn phase(record: &mut Record) {
    let text = "Under jitter phase drift accumulates steadily.";
    record.judge(Ruling { id: "C64", source: "7.4, 9.6", text, findings: &PHASES }, |f| {
        Judgement::refuted(format!(
            "with jitter of mean zero the phase performs a random walk with standard deviation \
             zσ√n: {} and {} rad at the end. Relative to the elapsed time it is only {} and {} \
             rad. A steady drift requires a clock with a wrong mean rate",
            number(f[0].measured, 3),
            number(f[1].measured, 3),
            number(f[2].measured, 2),
            number(f[3].measured, 2)
        ))
    });
}
