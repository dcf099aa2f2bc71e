//! The claims of the source report about energy.

use std::f64::consts::{E, TAU};

use libration::Method;
use libration_report::notation::{number, seconds};
use libration_report::record::{Finding, Judgement, Record, Ruling};
use libration_study::Config;

use super::{source_setting, tag};
use crate::drift::DriftSettings;

/// The z above which RK4 gains energy: 2√2.
const RK4_LIMIT: f64 = 2.0 * std::f64::consts::SQRT_2;

/// The drift of an energy that has grown e-fold: less does not tell an exponential from a line.
const E_FOLD: f64 = E - 1.0;

/// Judges them from the findings of the record.
pub(super) fn judge(config: &Config, record: &mut Record) {
    let long = long_enough(config);
    let ids =
        |m: Method, what: &str| -> Vec<String> { long.iter().map(|&dt| id(m, dt, what)).collect() };
    let seen = above_rounding(record, &ids(Method::ExplicitEuler, "largest"));
    let grown: Vec<String> = seen
        .into_iter()
        .filter(|id| record.finding(id).is_ok_and(|f| f.measured >= E_FOLD))
        .collect();
    explicit_euler(record, &grown);
    bounded(record, &ids);
    start_matters(record, &ids);
    let loses = |dt: &&f64| config.oscillator.omega() * **dt < RK4_LIMIT;
    let rk4: Vec<String> =
        long.iter().filter(loses).map(|&dt| id(Method::Rk4, dt, "largest")).collect();
    let seen = above_rounding(record, &rk4);
    steady_loss(record, &seen);
    without_symplecticity(record, &long, config.oscillator.omega());
    if source_setting::is_run(config) {
        source_setting::judge(record);
    }
    let text = "Two runs of the same start are equal to the bit, for every integrator.";
    rule(record, ("C26", "3.9, 6.6", text), &["drift.repeat".to_owned()], |f| {
        Judgement::holds_if(
            f[0].measured == 0.0,
            "also on several threads. In addition, a test of the project compares the bits with \
             those of a plain NumPy script",
        )
    });
    portraits(record, &long, config.oscillator.omega());
}

/// Turns of a run that may be called long.
const LONG: f64 = 10.0;

/// The time steps at which the run is long: a short one shows neither a swing nor a drift.
fn long_enough(config: &Config) -> Vec<f64> {
    let turns =
        |dt: f64| config.oscillator.omega() * dt * config.get::<DriftSettings>().steps as f64 / TAU;
    config.get::<DriftSettings>().dt.iter().copied().filter(|&dt| turns(dt) >= LONG).collect()
}

pub(super) fn id(method: Method, dt: f64, what: &str) -> String {
    format!("drift.{}.{}.{what}", method.name(), tag(dt))
}

/// Those of `ids` that the record holds: explicit Euler overflows at large steps.
fn existing(record: &Record, ids: &[String]) -> Vec<String> {
    ids.iter().filter(|id| record.finding(id).is_ok()).cloned().collect()
}

/// Those of `ids` whose measured value is more than rounding: the others are no evidence of a drift.
fn above_rounding(record: &Record, ids: &[String]) -> Vec<String> {
    let above = |f: &Finding| f.tolerance.tolerance.is_some_and(|rounding| f.measured > rounding);
    ids.iter().filter(|id| record.finding(id).is_ok_and(above)).cloned().collect()
}

/// Whether every measured value is within its rounding of zero.
fn only_rounding(findings: &[&Finding]) -> bool {
    findings.iter().all(|f| f.tolerance.tolerance.is_some_and(|rounding| f.measured <= rounding))
}

fn greatest(findings: &[&Finding]) -> f64 {
    findings.iter().map(|f| f.measured).fold(0.0, f64::max)
}

fn listed(findings: &[&Finding]) -> String {
    findings.iter().map(|f| number(f.measured, 3)).collect::<Vec<_>>().join(", ")
}

/// [`Record::judge`] with identifiers that were made at run time.
pub(super) fn rule(
    record: &mut Record,
    (id, source, text): (&str, &str, &str),
    findings: &[String],
    judge: impl FnOnce(&[&Finding]) -> Judgement,
) {
    let findings: Vec<&str> = findings.iter().map(String::as_str).collect();
    if !findings.is_empty() {
        record.judge(Ruling { id, source, text, findings: &findings }, judge);
    }
}

fn explicit_euler(record: &mut Record, seen: &[String]) {
    let text = "The amplitude of explicit Euler grows exponentially.";
    rule(record, ("C22", "3.5", text), seen, |f| {
        Judgement::confirmed(format!(
            "each step multiplies the energy by 1 + z². After the whole run its relative drift is \
             {} at the smallest time step with a visible drift, as predicted",
            number(f[0].measured, 5)
        ))
    });
}

fn bounded(record: &mut Record, ids: &impl Fn(Method, &str) -> Vec<String>) {
    let of = |what: &str| existing(record, &ids(Method::SymplecticEuler, what));
    let (kept, band, largest) = (of("invariant"), of("envelope"), of("largest"));
    if kept.is_empty() || band.is_empty() {
        return;
    }
    let tried = ids(Method::SymplecticEuler, "invariant").len();
    let text = "The energy of symplectic Euler oscillates and does not drift.";
    rule(record, ("C10", "2.9, 4.5", text), &[&kept[..], &band, &largest].concat(), |f| {
        let (kept_findings, rest) = f.split_at(kept.len());
        let (band_findings, largest) = rest.split_at(band.len());
        let because = format!(
            "the quadratic form that its step conserves changes by at most {}, which is rounding, \
             and the energy never leaves its band. The band is wide: at the steps tried the \
             relative energy drift is up to {}",
            number(greatest(kept_findings), 2),
            listed(largest)
        );
        match only_rounding(kept_findings) && only_rounding(band_findings) {
            false => Judgement::refuted(because),
            true if kept.len() == tried => Judgement::confirmed(because),
            true => Judgement::conditional(format!(
                "below z = 2, the side of the source’s own z = 0.00316: there {because}. At {} of the \
                 steps tried no form is definite, or rounding hides it",
                tried - kept.len()
            ))
            .only("below z = 2"),
        }
    });
}

fn start_matters(record: &mut Record, ids: &impl Fn(Method, &str) -> Vec<String>) {
    let of = |what: &str| existing(record, &ids(Method::VelocityVerlet, what));
    let (kept, largest, worst) = (of("invariant"), of("largest"), of("worst"));
    if kept.is_empty() {
        return;
    }
    let tried = ids(Method::VelocityVerlet, "invariant").len();
    let text = "The energy of velocity Verlet stays near that of a modified Hamiltonian.";
    rule(record, ("C12", "2.10", text), &[&kept[..], &largest, &worst].concat(), |f| {
        let (kept_findings, rest) = f.split_at(kept.len());
        let (largest, worst) = rest.split_at(largest.len());
        let because = format!(
            "½(v² + ω²(1 − z²/4)x²) changes by at most {}, which is rounding, where z < 2. The \
             result depends on the start, which the source does not say: at the steps tried the \
             relative energy drift is up to {} from the configured start and up to {} from the \
             worst",
            number(greatest(kept_findings), 2),
            listed(largest),
            listed(worst)
        );
        match only_rounding(kept_findings) {
            false => Judgement::refuted(because),
            true if kept.len() == tried => Judgement::confirmed(because),
            true => Judgement::conditional(because).only("below z = 2"),
        }
    });
}

fn steady_loss(record: &mut Record, seen: &[String]) {
    let text = "The energy of RK4 drifts steadily over long horizons.";
    rule(record, ("C15", "2.11, 3.8, 4.5", text), seen, |f| {
        Judgement::confirmed(format!(
            "each step multiplies the energy by 1 − z⁶/72 + z⁸/576. Where the drift exceeds \
             rounding, it is {} after the run",
            listed(f)
        ))
    });
}

/// Both non-symplectic methods at the smallest step at which RK4's loss is more than rounding.
fn without_symplecticity(record: &mut Record, dts: &[f64], omega: f64) {
    let shows = |dt: f64| -> Option<Vec<String>> {
        let rk4 = above_rounding(record, &[id(Method::Rk4, dt, "largest")]);
        let mut euler = above_rounding(record, &[id(Method::ExplicitEuler, dt, "largest")]);
        euler.extend(existing(record, &[id(Method::ExplicitEuler, dt, "overflow")]));
        (!rk4.is_empty() && !euler.is_empty()).then(|| [euler, rk4].concat())
    };
    let mut loses = dts.iter().filter(|&&dt| omega * dt < RK4_LIMIT);
    let Some((dt, evidence)) = loses.find_map(|&dt| Some((dt, shows(dt)?))) else { return };
    let text = "Non-symplectic methods produce long-term drift.";
    rule(record, ("C33", "4.6", text), &evidence, |f| {
        let gained = match f[0].unit.as_str() {
            "steps" => format!("has left the range of f64 at step {}", number(f[0].measured, 7)),
            _ => format!("has gained {}", number(f[0].measured, 3)),
        };
        Judgement::conditional(format!(
            "it holds for the two that are tried: at Δt = {} explicit Euler {gained}, and RK4 has \
             lost {}. As a rule it is too general: methods exist that conserve the energy exactly \
             without being symplectic; and the loss of RK4, z⁶/72 a step, is far below anything \
             visible at the source’s own z = 0.00316",
            seconds(dt, 3),
            number(f[1].measured, 3)
        ))
        .only("of methods that do not conserve the energy by other means")
    });
}

/// The claim about orbits, at the steps at which every method has the kind of orbit it names.
fn portraits(record: &mut Record, dts: &[f64], omega: f64) {
    let methods =
        [Method::ExplicitEuler, Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4];
    let mut evidence = Vec::new();
    for &dt in dts.iter().filter(|&&dt| omega * dt < RK4_LIMIT) {
        let found = existing(record, &methods.map(|m| id(m, dt, "envelope")));
        if found.len() == methods.len() {
            evidence.extend(found);
        }
    }
    let missing = dts.len() - evidence.len() / methods.len();
    let text = "In phase space explicit Euler spirals out, symplectic Euler traces an ellipse, Verlet \
                an almost closed orbit, and RK4 spirals slowly.";
    rule(record, ("C34", "4.7", text), &evidence, |f| {
        let because = "every orbit stays on the invariant curve of its step: exact ellipses for \
                       the symplectic methods, tilted for Euler, a spiral outwards for explicit \
                       Euler and one inwards for RK4";
        match only_rounding(f) {
            false => Judgement::refuted("orbits leave the invariant curves of their steps"),
            true if missing == 0 => Judgement::confirmed(because),
            true => Judgement::conditional(format!(
                "below z = 2, the side of the source’s own z = 0.00316: there {because}. At {missing} \
                 of the steps tried a method has no such orbit"
            ))
            .only("below z = 2"),
        }
    });
}
