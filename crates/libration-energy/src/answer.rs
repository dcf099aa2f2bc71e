//! The answer of an audit.

use libration_report::notation::{number, plural};

use crate::interval::exponent;
use crate::{DriftCause, EnergyReport, LargestDt, OscillationCause};

/// The answer in a few sentences.
pub(crate) fn answer(report: &EnergyReport) -> String {
    let faults: Vec<String> = report
        .findings
        .iter()
        .filter(|finding| finding.is_fault)
        .map(|finding| finding.kind.to_string())
        .collect();
    let names = match faults.len() {
        0 => format!("{}: no fault.", plural(report.runs.len(), "run")),
        count => format!("{}: {}.", plural(count, "fault"), faults.join(", ")),
    };
    let order = match (report.oscillation_cause, report.oscillation_law) {
        (OscillationCause::Truncation, Some(law)) => {
            format!(" The energy oscillates with order {}.", exponent(law.exponent))
        }
        (OscillationCause::Unclear, _) => {
            " How the oscillation depends on the step is unclear.".to_owned()
        }
        _ => String::new(),
    };
    let drift = match (report.drift_cause, report.drift_law) {
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
    format!("{names}{order}{drift}{assumed}{largest}")
}

fn longest(largest: &LargestDt) -> String {
    let required = format!(
        "a deviation of {}{} over {} s",
        number(largest.tolerance, 3),
        if largest.scale == 1.0 { "" } else { " of the energy" },
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
