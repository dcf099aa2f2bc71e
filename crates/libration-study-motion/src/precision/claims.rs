//! The claims of the source report about single precision and about phase.

use libration::Method;
use libration_report::notation::{list, number, seconds};
use libration_report::record::{Finding, Judgement, Record, Ruling};
use libration_study::{Config, source_report};

use super::tag;
use crate::precision::PrecisionSettings;

/// Drifts in both precisions that differ by no more than this part of themselves are “nearly identical”.
const NEARLY: f64 = 0.05;

/// A measurement that is off by less than this part of a prediction is mostly what was predicted.
const MOSTLY: f64 = 0.5;

/// A phase error in rad that can be seen in a plot of the orbit.
const VISIBLE: f64 = 0.1;

/// Judges them from the findings of the record.
pub(super) fn judge(config: &Config, record: &mut Record) {
    drifts(config, record);
    sufficient(config, record);
    let own_run = config.get::<PrecisionSettings>().steps == source_report::STEPS
        && config.get::<PrecisionSettings>().dt.contains(&source_report::DT);
    if source_report::is_source_orbit(config) && own_run {
        long_horizon(config, record);
    }
    rounded_step(config, record);
}

fn id(method: Method, dt: f64, what: &str) -> String {
    format!("precision.{}.{}.{what}", method.name(), tag(dt))
}

/// The findings `what` of these methods at all time steps, each with its setting, as far as the record holds
/// predictions of them.
fn found(
    config: &Config,
    record: &Record,
    methods: &[Method],
    what: &str,
) -> Vec<(Method, f64, String)> {
    let settings = config.get::<PrecisionSettings>();
    let all = settings.dt.iter().flat_map(|&dt| methods.iter().map(move |&m| (m, dt)));
    let ids = all.map(|(m, dt)| (m, dt, id(m, dt, what)));
    ids.filter(|(_, _, id)| record.finding(id).is_ok_and(|f| f.predicted.is_some())).collect()
}

/// [`Record::judge`] with identifiers that were made at run time; nothing without findings.
fn rule(
    record: &mut Record,
    (id, source, text): (&str, &str, &str),
    findings: &[(Method, f64, String)],
    judge: impl FnOnce(&[&Finding]) -> Judgement,
) {
    let findings: Vec<&str> = findings.iter().map(|(_, _, id)| id.as_str()).collect();
    if !findings.is_empty() {
        record.judge(Ruling { id, source, text, findings: &findings }, judge);
    }
}

/// The methods of which the source shows drifts in both precisions.
const CONSERVATIVE: [Method; 3] = [Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4];

/// Statement of the source about drifts in single precision.
fn drifts(config: &Config, record: &mut Record) {
    let settings = found(config, record, &CONSERVATIVE, "f32");
    let predicted = |f: &Finding| f.predicted.unwrap_or(f64::NAN);
    let ratio = |f: &Finding| f.measured / predicted(f);
    let alike = |f: &Finding| (ratio(f) - 1.0).abs() <= NEARLY;
    let evidence = |f: &[&Finding]| -> String {
        let one = |((m, dt, _), f): (&(Method, f64, String), &&Finding)| {
            format!("{} at {}: {}", m.title(), seconds(*dt, 3), number(ratio(f), 3))
        };
        settings.iter().zip(f).map(one).collect::<Vec<_>>().join("; ")
    };
    let verdict = |f: &[&Finding], because: String| match f.iter().filter(|f| alike(f)).count() {
        0 => Judgement::refuted(because),
        n if n == f.len() => Judgement::confirmed(because),
        _ => Judgement::conditional(because)
            .only("where the error of the method is far above its rounding, e.g. symplectic Euler"),
    };
    let text = "In single precision differences of energy drift are negligible.";
    rule(record, ("C43", "5.5", text), &settings, |f| {
        verdict(
            f,
            format!(
                "ratios of the largest drift in f32 to the drift without rounding: {}. Rounding is \
                 negligible only relative to a large error of the method",
                evidence(f)
            ),
        )
    });
    let text = "Energy drifts in single and double precision are nearly identical, since truncation \
                dominates; nothing diverges.";
    rule(record, ("C53", "7.1, 9.6", text), &settings, |f| {
        let largest = f.iter().map(|f| f.measured).fold(0.0, f64::max);
        verdict(
            f,
            format!(
                "the ratios are {}. None of these runs diverges: their largest drift is {}. The \
                 number of the source, δE ≈ 0.005, is the energy oscillation of symplectic Euler \
                 at z = 0.01, the method with the least visible rounding",
                evidence(f),
                number(largest, 2)
            ),
        )
    });
    let text = "Reduced precision is acceptable in most scenarios.";
    rule(record, ("C67a", "7.7", text), &settings, |f| {
        let largest = f.iter().map(|f| f.measured).fold(0.0, f64::max);
        let because = format!(
            "after the whole run none of symplectic Euler, velocity Verlet and RK4 has drifted by \
             more than {} in f32, mostly by the error of the method. {} of {} drifts are mostly \
             rounding; a better method or a smaller step does not reduce these",
            number(largest, 2),
            f.iter().filter(|f| ratio(f) > 2.0).count(),
            f.len()
        );
        match f.iter().all(|f| alike(f)) {
            true => Judgement::confirmed(because),
            false => Judgement::conditional(because)
                .only("where a drift as large as that of symplectic Euler is acceptable"),
        }
    });
}

/// Judges the claim about single precision in simulations for learning, which the source does not run.
fn sufficient(config: &Config, record: &mut Record) {
    let settings = found(config, record, &[Method::SymplecticEuler], "ahead");
    let text =
        "Single precision is sufficient for physics of the kind that reinforcement learning uses.";
    rule(record, ("C58a", "6.8, 9.7", text), &settings, |f| {
        let sizes: Vec<String> = f.iter().map(|f| number(f.measured.abs(), 2)).collect();
        let sizes: Vec<&str> = sizes.iter().map(String::as_str).collect();
        Judgement::not_reproducible(format!(
            "no policy was trained in either precision, so there is nothing to compare. After the \
             whole run of symplectic Euler f32 and f64 differ by {} rad, less than the error of \
             the method",
            list(&sizes)
        ))
    });
}

/// Judges the claims about a million steps.
fn long_horizon(config: &Config, record: &mut Record) {
    let symplectic = [Method::SymplecticEuler, Method::VelocityVerlet];
    let phases = found(config, record, &symplectic, "phase");
    let energies = found(config, record, &symplectic, "f64");
    let text = "Over a million steps phase errors accumulate, and the energy of symplectic methods \
                oscillates within bounds.";
    let both = [phases.clone(), energies].concat();
    rule(record, ("C59", "7.2", text), &both, |f| {
        let (phases, energies) = f.split_at(phases.len());
        let sizes: Vec<String> = phases.iter().map(|f| number(f.measured, 3)).collect();
        let sizes: Vec<&str> = sizes.iter().map(String::as_str).collect();
        // Bounded: the largest of a million is that of exact arithmetic.
        let bounded = energies.iter().all(|f| f.agrees());
        Judgement::holds_if(
            bounded && phases.iter().all(|f| f.measured > 0.0),
            format!(
                "each step rotates by θ − z ≈ z³/24 too far, which adds up to {} rad in a million \
                 steps; energies stay within the band of their step",
                list(&sizes)
            ),
        )
    });
    let verlet = found(config, record, &[Method::VelocityVerlet], "phase");
    let text = "Over a million steps the orbit visibly diverges from the analytical one.";
    rule(record, ("C59a", "7.2", text), &verlet, |f| {
        let sizes = verlet.iter().zip(f).map(|((_, dt, _), f)| {
            format!("{} rad at Δt = {}", number(f.measured, 3), seconds(*dt, 3))
        });
        let sizes: Vec<String> = sizes.collect();
        let because = format!(
            "for velocity Verlet the phase error is {}: per step it is proportional to Δt³",
            sizes.join(", ")
        );
        match f.iter().filter(|f| f.measured.abs() >= VISIBLE).count() {
            0 => Judgement::refuted(because),
            n if n == f.len() => Judgement::confirmed(because),
            // n·z³/24 = 0.1 at ω² = 10 and n = 10⁶.
            _ => Judgement::conditional(format!(
                "{because}. It reaches 0.1 rad at Δt = 4 ms, four times the step of the source"
            ))
            .only("from Δt ≈ 4 ms on"),
        }
    });
    dominated(config, record);
}

/// Whether the deviation of the orbit is one of phase or of size.
fn dominated(config: &Config, record: &mut Record) {
    let methods: Vec<Method> = config.integrators.clone();
    let phases = found(config, record, &methods, "phase");
    let sizes: Vec<(Method, f64, String)> =
        phases.iter().map(|&(m, dt, _)| (m, dt, id(m, dt, "f64"))).collect();
    let text = "Long-term deviation is dominated by phase error, not by energy.";
    rule(record, ("C59c", "7.2", text), &[phases.clone(), sizes].concat(), |f| {
        let (slips, drifts) = f.split_at(phases.len());
        // Relative to the amplitude, a phase error φ moves the state by φ, an energy drift δ by δ/2.
        let by_phase =
            |(slip, drift): (&&Finding, &&Finding)| slip.measured.abs() > drift.measured / 2.0;
        let mut others: Vec<&str> = phases
            .iter()
            .zip(slips.iter().zip(drifts))
            .filter(|(_, pair)| !by_phase(*pair))
            .map(|((m, ..), _)| m.title())
            .collect();
        others.dedup();
        let because = "relative to the amplitude a phase error φ moves the state by φ and an energy \
                       drift δ by δ/2; at the steps tried the first is larger";
        match others.as_slice() {
            [] => Judgement::confirmed(because),
            others => Judgement::conditional(format!("{because}, except for {}", list(others)))
                .only(format!("not for {}", list(others))),
        }
    });
}

/// The phase error of a time step that is rounded to `f32`.
fn rounded_step(config: &Config, record: &mut Record) {
    let settings = found(config, record, &[Method::VelocityVerlet], "ahead");
    let text = "A time step that is off by a part ε of itself changes the phase by ε of the time.";
    rule(record, ("C59b", "7.2", text), &settings, |f| {
        let all: Vec<String> = settings
            .iter()
            .zip(f)
            .map(|((_, dt, _), f)| {
                let off = f64::from(*dt as f32) / dt - 1.0;
                let (at, off) = (seconds(*dt, 3), number(off, 2));
                let by_step = number(f.predicted.unwrap_or(f64::NAN), 2);
                let ahead = number(f.measured, 2);
                format!(
                    "{ahead} rad at {at} (the rounding of this step, {off}, predicts {by_step} rad)"
                )
            })
            .collect();
        // Their tolerance has the roundings along the orbit too, and may be wider than the law.
        let near =
            |f: &&Finding| f.predicted.is_some_and(|p| (f.measured / p - 1.0).abs() < MOSTLY);
        Judgement::holds_if(
            f.iter().all(|f| f.agrees() && near(f)),
            format!(
                "runs in f32 are ahead of those in f64 by {}; the rest is rounding along the orbit",
                all.join("; ")
            ),
        )
    });
}
