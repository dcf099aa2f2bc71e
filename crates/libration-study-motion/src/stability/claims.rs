//! The claims of the source report about stable time steps.

use libration::Method;
use libration_report::notation::{count, number};
use libration_report::record::{Finding, Judgement, Record, Ruling};
use libration_study::Config;

use super::largest::{Case, Limit, limits};
use crate::stability::StabilitySettings;

/// Methods that the claims compare, in the order in which their findings are handed over.
const COMPARED: [Method; 4] =
    [Method::ExplicitEuler, Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4];

/// The stability limits of RK4 and velocity Verlet without a tolerance.
const BOUNDED: [&str; 2] = ["stability.rk4.window-1-to", "stability.velocity-verlet.window-1-to"];

/// A row of findings: a criterion, a horizon, and the largest steps of [`COMPARED`].
struct Row {
    label: String,
    steps: u64,
    dt: [f64; 4],
}

/// Judges them from the findings of the record.
pub(super) fn judge(config: &Config, record: &mut Record) {
    let drifts: Vec<(Limit, u64)> = rows(config, record, |l| matches!(l, Limit::Drift(_)));
    // From a tolerance of one on the energy bounds nothing that the spectrum does not.
    if drifts.iter().any(|(limit, _)| matches!(limit, Limit::Drift(tolerance) if *tolerance < 1.0))
    {
        by_drift(record, &drifts);
    }
    stricter(config, record);
    record.judge(
        Ruling {
            id: "C27",
            source: "4.1",
            text: "Stable means ρ ≤ 1, bounded and without growth; RK4 is so for short runs only.",
            findings: &BOUNDED,
        },
        |f| {
            Judgement::holds_if(
                f[0].measured < f[1].measured,
                format!(
                    "by that definition RK4 is stable up to z = {}, for runs of any length, and \
                     velocity Verlet up to {}",
                    number(f[0].measured, 7),
                    number(f[1].measured, 7)
                ),
            )
        },
    );
}

/// The criteria and horizons for which all compared methods have a finding.
fn rows(config: &Config, record: &Record, wanted: impl Fn(&Limit) -> bool) -> Vec<(Limit, u64)> {
    let all = limits(config).into_iter().filter(wanted);
    let horizons = &config.get::<StabilitySettings>().steps;
    all.flat_map(|limit| horizons.iter().map(move |&n| (limit, n)))
        .filter(|row| ids(&[*row]).iter().all(|id| record.finding(id).is_ok()))
        .collect()
}

fn ids(rows: &[(Limit, u64)]) -> Vec<String> {
    let of =
        |&(limit, steps): &(Limit, u64)| COMPARED.map(|method| Case { method, limit, steps }.id());
    rows.iter().flat_map(of).collect()
}

fn read(rows: &[(Limit, u64)], findings: &[&Finding]) -> Vec<Row> {
    let of = |(&(limit, steps), f): (&(Limit, u64), &[&Finding])| Row {
        label: limit.label(),
        steps,
        dt: [0, 1, 2, 3].map(|i| f[i].measured),
    };
    rows.iter().zip(findings.chunks(COMPARED.len())).map(of).collect()
}

impl Row {
    fn verlet_is_largest(&self) -> bool {
        let [explicit, euler, verlet, rk4] = self.dt;
        verlet > explicit && verlet > euler && verlet > rk4
    }
}

/// Rows in words: the horizons of each criterion, criteria in their order.
fn list(rows: &[&Row]) -> String {
    let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
    for row in rows {
        match groups.last_mut().filter(|(label, _)| *label == row.label) {
            Some((_, horizons)) => horizons.push(count(row.steps)),
            None => groups.push((&row.label, vec![count(row.steps)])),
        }
    }
    let group = |(label, horizons): &(&str, Vec<String>)| {
        format!("an {label} over {} steps", horizons.join(", "))
    };
    groups.iter().map(group).collect::<Vec<_>>().join("; ")
}

/// The horizons from which on Verlet allows the larger step, in words, and whether there are any.
fn ties(record: &Record) -> Option<String> {
    let series = record.series("crossovers").ok()?;
    let pairs = series.column("tolerance").ok()?.iter().zip(series.column("steps").ok()?);
    let words: Vec<String> = pairs
        .map(|(e, n)| format!("{} steps for a drift of {}", number(*n, 3), number(*e, 2)))
        .collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// The claims that say which method allows the largest step.
fn by_drift(record: &mut Record, rows: &[(Limit, u64)]) {
    let ids: Vec<String> = ids(rows);
    let ids: Vec<&str> = ids.iter().map(String::as_str).chain(BOUNDED).collect();
    let ties = ties(record);
    let later = |none: &str| match &ties {
        Some(ties) => format!("{none} that was tried, but beyond {ties}"),
        None => format!("{none} that was tried"),
    };
    let depends = |f: &[&Finding], extra: &str| {
        let (f, bounded) = f.split_at(f.len() - BOUNDED.len());
        let read = read(rows, f);
        let (verlet, others): (Vec<&Row>, Vec<&Row>) =
            read.iter().partition(|row| row.verlet_is_largest());
        let holds = match verlet.is_empty() {
            true => later("no criterion"),
            false => list(&verlet),
        };
        let rk4 =
            if others.is_empty() { String::new() } else { format!("{}, and for ", list(&others)) };
        let because = format!(
            "Verlet allows the largest step for {holds}; RK4 allows it for {rk4}boundedness \
             without a tolerance on the energy, up to z = {} against {}{extra}",
            number(bounded[0].measured, 4),
            number(bounded[1].measured, 4)
        );
        match verlet.is_empty() && ties.is_none() {
            true => Judgement::refuted(because),
            false => Judgement::conditional(because)
                .only("energy drift below a tolerance under 1, over more than N*(ε) steps"),
        }
    };
    let text = "The stable step is smallest for explicit Euler, moderate for symplectic Euler, and \
                largest for velocity Verlet; RK4’s serves short runs.";
    record.judge(Ruling { id: "C30", source: "4.4", text, findings: &ids }, |f| {
        depends(f, ". The source names neither tolerance nor horizon")
    });
    let text = "Velocity Verlet has the largest stable time step.";
    record.judge(Ruling { id: "C80", source: "9.3", text, findings: &ids }, |f| depends(f, ""));
    let text = "Velocity Verlet is the most suitable for long conservative runs.";
    record.judge(Ruling { id: "C35", source: "4.8", text, findings: &ids }, |f| {
        depends(f, ". This concerns the energy: in the state RK4 is more accurate at small steps")
    });
    let text = "Methods of higher order may do worse over long horizons.";
    let ids = &ids[..ids.len() - BOUNDED.len()];
    record.judge(Ruling { id: "C70", source: "8.3", text, findings: ids }, |f| {
        let read = read(rows, f);
        let worse: Vec<&Row> = read.iter().filter(|row| row.dt[3] < row.dt[2]).collect();
        let where_ = if worse.is_empty() { later("no criterion") } else { list(&worse) };
        let because = format!("RK4 allows a smaller step than Verlet for {where_}");
        match (worse.len(), &ties) {
            (0, None) => Judgement::refuted(because),
            (n, _) if n == read.len() => Judgement::confirmed(because),
            _ => Judgement::conditional(because).only("beyond N*(ε) steps"),
        }
    });
}

/// Whether a tolerance on the energy is stricter than one on the amplitude.
fn stricter(config: &Config, record: &mut Record) {
    let amplitude = rows(config, record, |l| matches!(l, Limit::Amplitude(_)));
    let drift = rows(config, record, |l| matches!(l, Limit::Drift(_)));
    let pairs: Vec<(Limit, u64)> = drift
        .iter()
        .filter_map(|row| Some([*row, *amplitude.iter().find(|a| a.1 == row.1)?]))
        .flatten()
        .collect();
    let ids = ids(&pairs);
    if ids.is_empty() {
        return;
    }
    let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
    let text = "A bound on the energy drift is stricter than the detection of explosions.";
    record.judge(Ruling { id: "C28", source: "4.2", text, findings: &ids }, |f| {
        let read = read(&pairs, f);
        let stricter = |pair: &&[Row]| {
            pair[0].dt.iter().zip(pair[1].dt).all(|(drift, amplitude)| *drift <= amplitude)
        };
        let (holds, fails): (Vec<&[Row]>, Vec<&[Row]>) = read.chunks(2).partition(stricter);
        let first = |pairs: &[&[Row]]| list(&pairs.iter().map(|pair| &pair[0]).collect::<Vec<_>>());
        let than = "than a bound on the amplitude, for each of the four methods";
        match (holds.is_empty(), fails.is_empty()) {
            (_, true) => Judgement::confirmed(format!(
                "it allows no larger step {than}, at every tolerance and horizon tried. With a \
                 tolerance of 1 or more both tests would be the same for velocity Verlet from \
                 rest, whose drift stays below 1 up to z = 2"
            )),
            (true, _) => Judgement::refuted(format!(
                "an {} lets one of the four take a larger step than a tenfold amplitude does",
                first(&fails).trim_start_matches("an ")
            )),
            _ => Judgement::conditional(format!(
                "it allows no larger step {than}, for {}; but for {} one of the four takes a \
                 larger step",
                first(&holds),
                first(&fails)
            ))
            .only("tolerances that an amplitude of ten times the start does not meet anyway"),
        }
    });
}
