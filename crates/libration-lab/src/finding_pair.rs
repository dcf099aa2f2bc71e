//! A finding of two runs.

use libration_report::record::{Agreement, Finding};
use libration_study::Study;

use crate::STUDIES;
use crate::results_comparison::Change;

/// A finding that differs, or that the second run alone has.
pub(crate) fn change(first: Option<&Finding>, second: &Finding) -> Change {
    Change {
        id: second.id.clone(),
        text: second.text.clone(),
        unit: second.unit.clone(),
        before: first.map_or(f64::NAN, |first| first.measured),
        after: second.measured,
        predicted: second.predicted,
        tolerance: second.tolerance.tolerance,
        verdicts: [first.map_or(Agreement::Measured, verdict), verdict(second)],
        predictions: first
            .map(|first| [first.predicted, second.predicted])
            .filter(|[before, after]| before != after),
        unit_before: first.map(|first| first.unit.clone()).filter(|unit| *unit != second.unit),
    }
}

/// The verdict that the numbers of a finding give, whatever its file says. Files have no infinities, of which the file alone knows.
pub(crate) fn verdict(own: &Finding) -> Agreement {
    match own.predicted.filter(|predicted| predicted.is_finite() && own.measured.is_finite()) {
        Some(predicted)
            if own.verdict == Agreement::Agrees
                && !own.relation.holds(predicted, own.measured, own.tolerance.tolerance) =>
        {
            Agreement::Disagrees
        }
        _ => own.verdict,
    }
}

/// Whether the second agrees with theory by a wider tolerance, or a weaker relation, alone.
pub(crate) fn is_loosened(first: &Finding, second: &Finding) -> bool {
    let [before, after] = [first, second].map(|finding| finding.tolerance.tolerance);
    let is_wider = before.zip(after).is_some_and(|(before, after)| after > before);
    let holds = |predicted| first.relation.holds(predicted, second.measured, before);
    (is_wider || first.relation != second.relation)
        && first.unit == second.unit
        && second.predicted.is_some_and(|predicted| !holds(predicted))
}

/// Whether measurements and predictions differ by no more than the tolerances of both.
pub(crate) fn is_within(first: &Finding, second: &Finding) -> bool {
    let [Some(one), Some(other)] = [first, second].map(|finding| finding.tolerance.tolerance)
    else {
        return false;
    };
    let [Some(before), Some(after)] = [first.predicted, second.predicted] else { return false };
    let allowed = one + other;
    (second.measured - first.measured).abs() <= allowed && (after - before).abs() <= allowed
}

/// Whether the second agrees with another prediction than the first, so that theory has moved with the measurement or to it.
///
/// Predictions differ by at most the tolerance of the first and the smaller one of both. A study that measures the machine may predict from
/// measurements.
pub(crate) fn is_moved(first: &Finding, second: &Finding) -> bool {
    let study = first.id.split('.').next().unwrap_or_default();
    let is_predicted =
        verdict(first) != Agreement::Measured && verdict(second) == Agreement::Agrees;
    if !is_predicted || first.unit != second.unit || measures_the_machine(study) {
        return false;
    }
    let [one, other] = [first, second].map(|finding| finding.tolerance.tolerance.unwrap_or(0.0));
    match (first.predicted, second.predicted) {
        (Some(before), Some(after)) => (after - before).abs() > one + one.min(other),
        (before, after) => before != after,
    }
}

fn measures_the_machine(study: &str) -> bool {
    STUDIES.by_name(study).is_some_and(Study::measures_the_machine)
}

/// Whether a finding is judged and undecided at once, which no run writes.
pub(crate) fn is_misstated(finding: &Finding) -> bool {
    finding.undecided.is_some() && finding.verdict != Agreement::Measured
}
