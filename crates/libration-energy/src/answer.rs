//! The answer of an audit.

use libration_report::notation::{number, plural};
use libration_report::verdict::Outcome;

use crate::interval::exponent;
use crate::{DriftCause, EnergyReport, FindingKind, LargestDt, OscillationCause};

/// The answer in a few sentences.
pub(crate) fn answer(report: &EnergyReport) -> String {
    let runs = plural(report.runs.len(), "run");
    let verdict = &report.verdict;
    let names = match verdict.outcome {
        Outcome::Fault => {
            let count = report.findings.iter().filter(|finding| finding.is_fault).count();
            format!("{}: {}", plural(count, "fault"), verdict.evidence)
        }
        Outcome::NoFault => format!("{runs}: {}", verdict.outcome),
        _ => format!("{runs}: unknown whether there is a fault, as {}", verdict.evidence),
    };
    let kept = report.tolerance_verdict.as_ref().map_or_else(String::new, |verdict| match verdict
        .outcome
    {
        Outcome::Exceeds => format!("; the tolerance is exceeded: {}", verdict.evidence),
        Outcome::Within => format!("; within the tolerance: {}", verdict.evidence),
        _ => format!("; unknown whether the tolerance is kept: {}", verdict.evidence),
    });
    let limits = match verdict.limits() {
        limits if limits.is_empty() => limits,
        limits => format!(" {limits}"),
    };
    let order = match (report.oscillation_cause, report.oscillation_law) {
        (OscillationCause::Truncation, Some(law)) => {
            format!(" The energy oscillates with order {}.", exponent(law.exponent))
        }
        _ => String::new(),
    };
    let drift = match (report.drift_cause, report.drift_law) {
        // A slow change that is no line is told as a fault or as unclear.
        (DriftCause::Unresolved, _) if changes_slowly(report) => String::new(),
        (DriftCause::Unresolved, _) => {
            let bound = report.runs.iter().map(|run| run.drift_rate.largest_size());
            format!(
                " No drift is resolved: at most {} per second.",
                number(bound.fold(0.0, f64::max), 2)
            )
        }
        (DriftCause::Truncation, Some(law)) => {
            format!(" The drift rate has order {}.", exponent(law.exponent))
        }
        _ => String::new(),
    };
    let assumed = match report.is_dt_assumed {
        true => {
            " dt assumed: the spacing of the samples. The largest step requires the time steps (--dt)."
        }
        false => "",
    };
    let largest = report.largest_dt.as_ref().map_or_else(String::new, longest);
    format!("{names}{kept}.{limits}{order}{drift}{assumed}{largest}")
}

fn changes_slowly(report: &EnergyReport) -> bool {
    report.findings.iter().any(|finding| {
        matches!(finding.kind, FindingKind::StepIndependentDrift | FindingKind::UnclearDrift)
    })
}

fn longest(largest: &LargestDt) -> String {
    let required = format!(
        "a deviation of {} over {} s",
        largest.allowed_in_words(),
        number(largest.horizon, 4)
    );
    let Some(dt) = largest.dt else {
        return match largest.is_unknown {
            true => format!(
                " The largest step for {required} is unknown: the runs do not tell how all parts depend on the step."
            ),
            false => {
                format!(" No step meets {required}, down to {} s.", number(largest.shortest_dt, 2))
            }
        };
    };
    let least = if largest.is_limited_by_runs { "at least " } else { "" };
    let range = match (largest.low, largest.high) {
        _ if largest.is_limited_by_runs && largest.low == Some(dt) => String::new(),
        (Some(low), Some(high)) => format!(" ({} to {} s)", number(low, 3), number(high, 3)),
        _ => " (it may be that no step does)".to_owned(),
    };
    let beyond = match largest.is_extrapolated {
        true => ", shorter than those of the runs",
        false => "",
    };
    format!(" The largest step for {required}: {least}{} s{range}{beyond}.", number(dt, 3))
}
