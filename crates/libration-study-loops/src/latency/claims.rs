//! The claims of the source report about latency.

use libration_report::Record;
use libration_report::notation::number;
use libration_report::record::{Judgement, Ruling};

use super::critical_latency::FACTORS;

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    amplitude(record);
    damping(record);
    precision(record);
}

fn amplitude(record: &mut Record) {
    let findings = [
        "latency.force-0.long",
        "latency.force-1.short",
        "latency.force-1.long",
        "latency.force-1.law",
        "latency.force-1.explicit-euler",
    ];
    let text = "Latency increases the amplitude of oscillations.";
    record.judge(Ruling { id: "C61", source: "7.3", text, findings: &findings }, |f| {
        let [none, short, long] = [0, 1, 2].map(|i| f[i].measured);
        let grows = (none - 1.0).abs() < 1e-6 && short > 1.0 && long > short;
        Judgement::holds_if(
            grows,
            format!(
                "if the force is one step of 1 ms late, the amplitude is {} times as large after \
                 1000 steps, and {} times after a million; without latency it is constant. It \
                 grows by ½z²d per step at any latency of d steps: one step late, symplectic Euler \
                 is explicit Euler, bit for bit",
                number(short, 5),
                number(long, 4)
            ),
        )
    });
}

fn damping(record: &mut Record) {
    let mut findings = vec![
        "latency.damping.in-time".to_owned(),
        "latency.damping.late".to_owned(),
        "latency.force-1.law".to_owned(),
    ];
    findings.extend(FACTORS.iter().map(|factor| format!("latency.onset.gains-{factor}")));
    let findings: Vec<&str> = findings.iter().map(String::as_str).collect();
    let text = "Latency slows damping, and may make a loop unstable at higher gains.";
    record.judge(Ruling { id: "C62", source: "7.3", text, findings: &findings }, |f| {
        let [in_time, late, free] = [0, 1, 2].map(|i| f[i].measured);
        let onsets: Vec<f64> = f[3..].iter().map(|f| f.measured).collect();
        let falls = onsets.windows(2).all(|pair| pair[1] < pair[0]);
        let told: Vec<String> = FACTORS
            .iter()
            .zip(&onsets)
            .map(|(factor, d)| {
                format!("{} at {} times the gains", number(*d, 4), number(*factor, 2))
            })
            .collect();
        let because = format!(
            "at half of the critical latency the loop loses {} of its amplitude per step, without \
             latency {}. The critical latency in steps is {}. Without damping no latency is \
             stable: the amplitude grows by ½z²d per step at any gain, by {} in the measurement at \
             1 ms",
            number(-late, 3),
            number(-in_time, 3),
            told.join(", "),
            number(free, 3)
        );
        match in_time < late && late < 0.0 && falls && free > 0.0 {
            true => Judgement::conditional(because)
                .only("the loop is damped; without damping it is unstable at every gain"),
            false => Judgement::refuted(because),
        }
    });
}

fn precision(record: &mut Record) {
    let findings = ["latency.single.short-ratio", "latency.single.long-ratio"];
    let text = "Latency is more destabilising than single precision.";
    record.judge(Ruling { id: "C63", source: "7.3, 9.6", text, findings: &findings }, |f| {
        let [short, long] = [f[0].measured, f[1].measured];
        Judgement::holds_if(
            short > 1.0 && long > 1.0,
            format!(
                "one step of latency adds {} times as much to the amplitude in 1000 steps as single precision \
                 moves the orbit, and {} times as much in a million: the one grows exponentially, the other \
                 hardly faster than the number of steps",
                number(short, 2),
                number(long, 2)
            ),
        )
    });
}
