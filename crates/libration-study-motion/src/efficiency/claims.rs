//! The claims of the source report about cost.

use libration_report::notation::number;
use libration_report::record::{Finding, Judgement, Record, Ruling};

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    let names = ["explicit-euler", "symplectic-euler", "velocity-verlet", "rk4"];
    let ids: Vec<String> = ["evaluations", "time"]
        .iter()
        .flat_map(|what| names.map(|name| format!("efficiency.{name}.{what}")))
        .collect();
    let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
    let text = "Explicit and symplectic Euler are fast, velocity Verlet slightly slower, RK4 the most \
                expensive.";
    record.judge(Ruling { id: "C81", source: "9.3", text, findings: &ids }, |f| {
        let (evaluations, time) = f.split_at(names.len());
        let values = |f: &[&Finding]| [0, 1, 2, 3].map(|i| f[i].measured);
        let (counts, times) = (values(evaluations), values(time));
        let list = |x: [f64; 4]| x.map(|x| number(x, 2)).join(", ");
        let because = format!(
            "force evaluations a step: {}; time: {} ns. Verlet evaluates the force twice per step \
             here, and takes {} times as long as symplectic Euler; once would suffice, since the \
             last force of a step is the first of the next. But a comparison per step is not \
             meaningful; compare the work for a given accuracy",
            list(counts),
            list(times),
            number(times[2] / times[1], 2)
        );
        let [explicit, euler, verlet, rk4] = counts;
        let ordered = explicit == euler && euler < verlet && verlet < rk4;
        // “Slightly” is what half as much again still is.
        match (ordered, times[2] < 1.5 * times[1]) {
            (true, true) => Judgement::confirmed(because),
            (true, false) => Judgement::conditional(because)
                .only("without “slightly”: Verlet takes up to twice as long"),
            _ => Judgement::refuted(because),
        }
    });
}
