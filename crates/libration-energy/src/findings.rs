//! The findings and the answer of an audit.

use libration_report::notation::number;

use crate::FindingKind as Kind;
use crate::convergence::Convergence;
use crate::interval::{exponent, interval};
use crate::local_deviations::Roughness;
use crate::slow_change::SlowChange;
use crate::{DriftCause, EnergyReport, EnergyTrace, Finding, PowerLaw, Run, WalkCause};
use crate::{local_findings, oscillation_findings};

/// Exponents below this are of first order.
const FIRST_ORDER: f64 = 1.5;
/// Correlation of neighbouring samples below which a trace is thinned: a phase of 60° per sample, far beyond the accuracy of any step.
const THINNED: f64 = 0.5;
/// Part of an advised duration from which on a run has it.
const LONG: f64 = 1.05;
/// Roundings of single precision by which a step with 1 to 10⁴ terms may change the energy.
const SINGLE: f64 = 6e-8;

/// All findings, faults first.
pub(crate) fn findings(
    report: &EnergyReport,
    traces: &[&EnergyTrace],
    scale: Option<f64>,
    slow: Option<SlowChange>,
) -> Vec<Finding> {
    let roughness: Vec<Roughness> =
        traces.iter().zip(&report.runs).map(|(trace, run)| Roughness::of(trace, run)).collect();
    let convergence = Convergence::of(traces, &report.runs, &roughness, scale);
    let mut found = Vec::new();
    found.extend(drift(report));
    found.extend(oscillation_findings::step_independent(report, &convergence));
    found.extend(oscillation_findings::first_order(report));
    found.extend(oscillation_findings::unclear(report));
    found.extend(walk(report));
    // A jump is told with its time.
    let local = local_findings::local(&report.runs, &roughness);
    if local.is_none() && !found.iter().any(|finding| finding.is_fault) {
        let is_told = found.iter().any(|finding| finding.kind == Kind::UnclearDrift);
        let slow = slow.filter(|slow| slow.is_of_all || !is_told);
        found.extend(slow.and_then(|slow| slow.finding(&report.runs)));
    }
    if convergence.is_saturated {
        // How such energies depend on the step says nothing of the program, but for a drift of first order, which diverges.
        found.retain(|finding| finding.kind == Kind::FirstOrderDrift);
    }
    if !found.iter().any(|finding| finding.is_fault || finding.kind == Kind::NotConverged) {
        found.extend(convergence.reason.map(|reason| Finding::new(Kind::NotConverged, reason)));
    }
    if !convergence.is_saturated {
        found.extend(local);
    }
    found.extend(short_run(report));
    found.extend(different_start(&report.runs));
    found.extend(thinned(traces));
    found.extend(coarse(report));
    found.sort_by_key(|finding| !finding.is_fault);
    found
}

fn proportion(law: Option<PowerLaw>) -> String {
    law.map_or_else(
        || "the other runs resolve none".to_owned(),
        |law| format!("it is proportional to dt^{}", exponent(law.exponent)),
    )
}

/// Largest relative change of an energy in a step that double precision explains: a hundred roundings.
const DOUBLE: f64 = 100.0 * f64::EPSILON;

fn drift(report: &EnergyReport) -> Option<Finding> {
    let run = report.runs.iter().find(|run| run.drifts())?;
    let is_double = (run.drift_rate.value * run.dt).abs() < DOUBLE * run.largest_energy;
    if is_double && matches!(report.drift_cause, DriftCause::Rounding | DriftCause::Unclear) {
        return None;
    }
    let rates = format!(
        "the energy drifts by {} per second at dt = {} s",
        interval(run.drift_rate, 3),
        number(run.dt, 4)
    );
    let relative = match run.is_exponential {
        true => "; it grows or falls exponentially",
        false => "",
    };
    let law = proportion(report.drift_law);
    let is_first_order = report.drift_law.is_some_and(|law| law.exponent.value < FIRST_ORDER);
    let (kind, why) = match report.drift_cause {
        DriftCause::Unresolved => return None,
        DriftCause::StepIndependent => (
            Kind::StepIndependentDrift,
            "whatever the step: the force is no gradient of this energy, or the system is damped or driven".to_owned(),
        ),
        DriftCause::Rounding => (
            Kind::RoundingDrift,
            format!("and the faster, the shorter the step: rounding with a bias in each step{}", precision(run)),
        ),
        DriftCause::Truncation if is_first_order => (
            Kind::FirstOrderDrift,
            "at a rate of first order in the step, as of explicit Euler".to_owned(),
        ),
        DriftCause::Truncation => (Kind::TruncationDrift, "by truncation".to_owned()),
        DriftCause::Unclear => {
            (Kind::UnclearDrift, "and the runs do not tell how the rate depends on the step".to_owned())
        }
    };
    Some(Finding::new(kind, format!("{rates}{relative}, {why}; {law}")))
}

/// That a trace shows single precision; else nothing.
fn precision(run: &Run) -> &'static str {
    match run.is_single_precision {
        true => "; all energies are numbers of single precision",
        false => "",
    }
}

fn walk(report: &EnergyReport) -> Option<Finding> {
    let run = report.runs.iter().find(|run| run.present_walk().is_some())?;
    let diffusion = run.present_walk()?.diffusion;
    let per_step = (diffusion.value * run.dt).sqrt() / run.largest_energy;
    if per_step < DOUBLE {
        return None;
    }
    let size = format!(
        "the energy wanders as a random walk of {} per step, {} of the largest energy, at dt = {} s",
        number(per_step * run.largest_energy, 2),
        number(per_step, 2),
        number(run.dt, 4)
    );
    let law = proportion(report.walk_law);
    let single = match per_step > 0.01 * SINGLE && per_step < 100.0 * SINGLE {
        true => "; single precision rounds by 6e-8",
        false => "",
    };
    let (kind, why) = match report.walk_cause {
        WalkCause::Absent => return None,
        // Slow motions of a system do the same, and no fault is needed to explain them.
        WalkCause::Truncation => return None,
        WalkCause::Rounding => (Kind::RoundingWalk, "farther with shorter steps: rounding"),
        WalkCause::StepIndependent => {
            (Kind::StepIndependentWalk, "as far with each step: random forces")
        }
        WalkCause::Unclear => {
            (Kind::UnclearWalk, "and the runs do not tell how it depends on the step")
        }
    };
    Some(Finding::new(
        kind,
        format!("{size}, {why}{single}{}; its variance per second: {law}", precision(run)),
    ))
}

fn short_run(report: &EnergyReport) -> Option<Finding> {
    let largest = report.largest_dt.as_ref()?;
    let duration = largest.resolving_duration?;
    let run =
        report.runs.iter().rev().find(|run| Some(run.dt) <= largest.dt).or(report.runs.first())?;
    let interval = format!(
        "over {} s the interval of the drift, {} per second, is no small part of the tolerance",
        number(largest.horizon, 4),
        interval(run.drift_rate, 2)
    );
    if duration <= LONG * run.duration {
        let help = "compare the largest deviation of the runs with the tolerance";
        let text = format!(
            "{interval}; the runs are as long as the horizon, and deviate by at most {}",
            number(run.largest_deviation, 2)
        );
        return Some(Finding { help: help.to_owned(), ..Finding::new(Kind::ShortRun, text) });
    }
    Some(Finding::new(
        Kind::ShortRun,
        format!("{interval}; runs of about {} s would resolve it", number(duration, 2)),
    ))
}

fn different_start(runs: &[Run]) -> Option<Finding> {
    let by_start = |a: &&Run, b: &&Run| a.energy_at_start.total_cmp(&b.energy_at_start);
    let (low, high) = (runs.iter().min_by(by_start)?, runs.iter().max_by(by_start)?);
    let most = runs.iter().map(|run| run.largest_deviation).fold(0.0, f64::max);
    (high.energy_at_start - low.energy_at_start > 2.0 * most).then(|| {
        Finding::new(
            Kind::DifferentStart,
            format!(
                "`{}` starts with the energy {} and `{}` with {}, farther apart than any deviation of a run",
                low.title,
                number(low.energy_at_start, 8),
                high.title,
                number(high.energy_at_start, 8)
            ),
        )
    })
}

fn thinned(traces: &[&EnergyTrace]) -> Option<Finding> {
    let thin = |trace: &&&EnergyTrace| trace.dt.is_none() && neighbours(&trace.energies) < THINNED;
    let trace = traces.iter().find(thin)?;
    Some(Finding::new(
        Kind::Thinned,
        format!(
            "neighbouring energies of `{}` hardly agree (correlation {}): it seems thinned, and its time step is shorter than the {} s between samples",
            trace.title,
            number(neighbours(&trace.energies), 2),
            number(trace.spacing(), 4)
        ),
    ))
}

/// The correlation of neighbouring values, by their mean squared difference (von Neumann).
fn neighbours(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    let changes = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>();
    1.0 - 0.5 * changes / variance.max(f64::MIN_POSITIVE)
}

fn coarse(report: &EnergyReport) -> Option<Finding> {
    let run = report.runs.iter().find(|run| !run.resolves_oscillation())?;
    let allowed = report.largest_dt.map(|largest| largest.tolerance * largest.scale)?;
    // What is far below the tolerance does not matter.
    (run.resolution > 0.1 * allowed).then(|| {
        Finding::new(
            Kind::CoarseEnergy,
            format!(
                "energies of `{}` are stored in steps of {}, as large as their fluctuation",
                run.title,
                number(run.resolution, 2)
            ),
        )
    })
}
