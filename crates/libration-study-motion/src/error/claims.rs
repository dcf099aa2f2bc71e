//! The claims of the source report about errors.

use libration_report::notation::{count, number};
use libration_report::record::{Finding, Judgement, Record, Ruling};
use libration_study::{Config, source_report};

use crate::error::ErrorSettings;

/// The numbers that §9.2 of the source prints, and half a unit of their last digit.
const PRINTED: [(&str, &str, &str, f64, f64); 4] = [
    ("C74", "explicit-euler", "explicit Euler", 32.73, 0.005),
    ("C75", "symplectic-euler", "symplectic Euler", 0.00383, 0.000005),
    ("C76", "velocity-verlet", "velocity Verlet", 0.00272, 0.000005),
    ("C77", "rk4", "RK4", 0.90339, 0.000005),
];

/// Judges them from the findings of the record, where the setting is the source's own.
pub(super) fn judge(config: &Config, record: &mut Record) {
    let is_its_run = (config.get::<ErrorSettings>().dt, config.get::<ErrorSettings>().steps)
        == (source_report::DT, source_report::STEPS);
    if !is_its_run || !source_report::is_source_orbit(config) {
        return;
    }
    for (id, method, title, printed, digits) in PRINTED {
        let text = format!("The final L2 error of {title} is {printed}.");
        let ids = ["aligned", "late"].map(|kind| format!("error.{method}.{kind}"));
        let ids = [ids[0].as_str(), &ids[1]];
        let (source, text) = ("9.2", text.as_str());
        record.judge(Ruling { id, source, text, findings: &ids }, |f| {
            number_of_the_source(f, printed, digits)
        });
    }
    final_or_not(record);
    ranking(record);
}

fn number_of_the_source(f: &[&Finding], printed: f64, digits: f64) -> Judgement {
    let (aligned, late) = (f[0].measured, f[1].measured);
    let prints = |x: f64| (x - printed).abs() <= digits;
    let both = format!(
        "relative to the solution at the same time it is {}, relative to the solution one step \
         before it is {}",
        number(aligned, 6),
        number(late, 6)
    );
    match (prints(aligned), prints(late)) {
        (true, _) => Judgement::confirmed(format!("as a root mean square over all steps: {both}")),
        (false, true) => Judgement::conditional(format!(
            "only if states are compared with the solution one step too early: {both}. The source \
             states neither the step nor the number of steps; only this setting reproduces its \
             first three numbers"
        ))
        .only("states are compared with the solution one step earlier"),
        (false, false) => Judgement::not_reproducible(format!(
            "{both}. Neither comparison gives {printed}; the table of mistakes in RK4 shows which \
             ones come near it"
        )),
    }
}

fn final_or_not(record: &mut Record) {
    let names = ["explicit-euler", "symplectic-euler", "velocity-verlet"];
    let ids: Vec<String> = ["last", "late"]
        .iter()
        .flat_map(|kind| names.map(|name| format!("error.{name}.{kind}")))
        .collect();
    let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
    let text = "The numbers are final L2 errors.";
    record.judge(Ruling { id: "C78", source: "9.2", text, findings: &ids }, |f| {
        let (last, late) = f.split_at(3);
        let near = |f: &Finding, printed: f64| (f.measured.abs() / printed - 1.0).abs() < 2e-3;
        let printed = [32.73, 0.00383, 0.00272];
        let is_final = last.iter().zip(printed).all(|(f, p)| near(f, p));
        let is_mean = late.iter().zip(printed).all(|(f, p)| near(f, p));
        let sizes: Vec<String> = last.iter().map(|f| number(f.measured.abs(), 3)).collect();
        Judgement::holds_if(
            is_final,
            format!(
                "the errors after the last step are {}; the printed numbers {} the root mean \
                 square over all steps",
                sizes.join(", "),
                if is_mean { "are" } else { "are not even" }
            ),
        )
    });
}

fn ranking(record: &mut Record) {
    let ids = [
        "error.rk4.aligned",
        "error.velocity-verlet.aligned",
        "error.symplectic-euler.aligned",
        "error.explicit-euler.aligned",
        "error.rk4.late",
    ];
    let text = "Symplectic Euler and velocity Verlet stay highly accurate, RK4 drifts noticeably \
                although its order is high.";
    record.judge(Ruling { id: "C79", source: "9.2", text, findings: &ids }, |f| {
        let [rk4, verlet, euler, explicit] = [0, 1, 2, 3].map(|i| f[i].measured);
        Judgement::holds_if(
            rk4 > verlet,
            format!(
                "the order is the reverse: RK4 {}, velocity Verlet {}, symplectic Euler {}, explicit \
                 Euler {}",
                number(rk4, 3),
                number(verlet, 3),
                number(euler, 3),
                number(explicit, 3)
            ),
        )
    });
    let text = "The theory of chapter 2 fully explains what the experiments of phase 2 showed.";
    record.judge(Ruling { id: "C19", source: "2.12", text, findings: &[ids[0], ids[4]] }, |f| {
        let theory = f[1].predicted.unwrap_or(f64::NAN);
        Judgement::holds_if(
            (theory - 0.90339).abs() < 0.000005,
            format!(
                "by theory the error of RK4 is {} in the comparison of the source, and the RK4 of \
                 this run agrees over {} steps; the source prints 0.90339 and calls it consistent",
                number(theory, 3),
                count(1_000_000)
            ),
        )
    });
}
