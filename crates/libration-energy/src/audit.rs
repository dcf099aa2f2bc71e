//! The audit of energy traces.

use libration_report::verdict::Verdict;

use crate::answer::answer;
use crate::cause::OscillationCause;
use crate::findings::findings;
use crate::power_law::PowerLaw;
use crate::slow_change::SlowChange;
use crate::trace::checked;
use crate::verdicts::{of_faults, of_tolerance};
use crate::{
    DriftCause, EnergyReport, EnergyTrace, Estimate, FindingKind, LargestDt, Requirement, Run,
    TraceError, WalkCause,
};

/// Audits the energies of runs of the same system at several time steps.
///
/// # Errors
///
/// Returns an error for fewer than two traces, equal time steps, numbers that are not finite, constant energies, runs that are too short
/// and runs of different durations.
pub fn audit(traces: &[EnergyTrace], requirement: Requirement) -> Result<EnergyReport, TraceError> {
    requirement.check()?;
    let sorted = checked(traces)?;
    let mut runs = Vec::with_capacity(sorted.len());
    for trace in &sorted {
        let run =
            Run::of(trace).ok_or_else(|| TraceError::Overflow { title: trace.title.clone() })?;
        runs.push(run);
    }
    let oscillation_cause = OscillationCause::of(&runs);
    let drift_cause = DriftCause::of(&runs);
    let law = |sizes: &dyn Fn(&Run) -> Option<Estimate>| {
        let points: Vec<(f64, Estimate)> =
            runs.iter().filter_map(|run| Some((run.dt, sizes(run)?))).collect();
        PowerLaw::fit(&points)
    };
    let oscillation_law = law(&|run| run.resolves_oscillation().then_some(run.oscillation));
    let drift_law = law(&|run| run.drifts().then_some(run.drift_rate));
    let walk_law = law(&|run| run.present_walk().map(|walk| walk.diffusion));
    let walk_cause = WalkCause::of(&runs, walk_law);
    // A drift or an oscillation that does not fall with the step is the same change.
    let is_explained = oscillation_cause == OscillationCause::StepIndependent
        || drift_cause == DriftCause::StepIndependent;
    let slow = SlowChange::of(&sorted, &runs).filter(|_| !is_explained);
    let search = LargestDt::search(
        &runs,
        requirement,
        (oscillation_cause, drift_cause, walk_cause),
        (drift_law.map(|law| law.exponent.value), walk_law.map(|law| law.exponent.value)),
        slow,
    );
    let (largest_dt, predicted) = search.unzip();
    let mut report = EnergyReport {
        answer: String::new(),
        verdict: Verdict::unknown("not judged"),
        tolerance_verdict: None,
        findings: Vec::new(),
        runs,
        oscillation_cause,
        oscillation_law,
        drift_cause,
        drift_law,
        walk_cause,
        walk_law,
        is_dt_assumed: sorted.iter().any(|trace| trace.dt.is_none()),
        largest_dt,
        warnings: Vec::new(),
        libration_version: env!("CARGO_PKG_VERSION"),
        repeat_command: String::new(),
    };
    report.findings = findings(&report, &sorted, requirement.scale, slow);
    report.verdict = of_faults(&report);
    if let (Some(largest), Some(predicted), Some(_)) =
        (largest_dt, predicted, requirement.tolerance)
    {
        report.tolerance_verdict = Some(of_tolerance(&report, &sorted, &largest, &predicted));
    }
    let is_unknown = report.findings.iter().any(|own| own.kind == FindingKind::NotConverged);
    if let Some(largest) = report.largest_dt.as_mut().filter(|_| is_unknown) {
        // Laws of runs that do not converge hold at no other step.
        *largest = LargestDt { dt: None, low: None, high: None, is_unknown, ..*largest };
    }
    if report.is_dt_assumed {
        // Of samples that are thinned it would be too large by the thinning.
        report.largest_dt = None;
    }
    report.answer = answer(&report);
    Ok(report)
}
