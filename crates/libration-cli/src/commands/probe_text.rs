//! An audit of a step as text.

use std::fmt::Write as _;

use libration_probe::{ProbeReport, error_in_words};
use libration_report::notation::{number, plural};

/// Returns the report as text.
pub(super) fn describe(report: &ProbeReport) -> String {
    let mut text = format!("{}\n", report.answer);
    for finding in &report.findings {
        let kind = if finding.is_fault { "fault" } else { "warning" };
        let _ = writeln!(text, "{kind}: {}: {}", finding.kind, finding.text);
        let _ = writeln!(text, "help: {}", finding.help);
    }
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    modes(report, &mut text);
    latency(report, &mut text);
    integrator(report, &mut text);
    defects(report, &mut text);
    let same = report.bits.checks.iter().filter(|check| check.difference.is_none());
    let names: Vec<&str> = same.map(|check| check.name.as_str()).collect();
    if !names.is_empty() {
        let _ = writeln!(text, "the same bits: {}", names.join("; "));
    }
    if let Some(confirmation) = &report.confirmation {
        let _ = writeln!(
            text,
            "relative error of the matrices: {}; of a run of {}: {}",
            error_in_words(report.jacobian_error),
            plural(confirmation.steps, "step"),
            error_in_words(confirmation.error)
        );
    }
    if let Some(reference) = &report.reference {
        let _ = writeln!(
            text,
            "the matrices of {} differ from it by at most {} of a row",
            reference.source,
            number(reference.difference, 2)
        );
    }
    let _ = writeln!(text, "repeat with: {}", report.repeat_command);
    text
}

fn rounded(x: f64) -> String {
    number(x, 5)
}

fn known(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), rounded)
}

fn modes(report: &ProbeReport, text: &mut String) {
    if report.modes.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<36} {:>11} {:>12} {:>12} {:>12} {:>12} {:>12}",
        "mode in", "|z|", "growth 1/s", "of system", "freq. Hz", "of system", "num. damping"
    );
    for mode in &report.modes {
        let flow = mode.flow;
        let _ = writeln!(
            text,
            "{:<36} {:>11} {:>12} {:>12} {:>12} {:>12} {:>12}",
            mode.names(),
            number(mode.radius, 8),
            rounded(mode.step.growth_rate),
            known(flow.map(|flow| flow.growth_rate)),
            rounded(mode.step.frequency),
            known(flow.map(|flow| flow.frequency)),
            known(mode.numerical_damping)
        );
    }
}

fn latency(report: &ProbeReport, text: &mut String) {
    for (i, latency) in report.hidden_latency.iter().enumerate() {
        let start = if i == 0 { "\n" } else { "" };
        let late = match latency.late_steps {
            None => "late by an unknown time, not examined".to_owned(),
            Some(0.0) => "not late".to_owned(),
            Some(1.0) => "1 step late".to_owned(),
            Some(late) => format!("{} steps late", number(late, 4)),
        };
        let _ = write!(text, "{start}latency of {}: {late}", latency.input);
        if let Some(delay) = latency.integrator_delay {
            let by = latency.state.as_deref().unwrap_or("-");
            let delay = number(delay, 3);
            let _ = write!(text, "; the integrator delays it by {delay} s (phase of {by})");
        }
        text.push('\n');
    }
}

fn defects(report: &ProbeReport, text: &mut String) {
    let Some(defects) = &report.defects else { return };
    let beside = |what: &str, x: Option<f64>| {
        x.map_or_else(String::new, |x| format!(" ({what} {})", rounded(x)))
    };
    let system = beside("of the system", defects.flow_volume_rate);
    let volume = rounded(defects.volume_rate);
    let _ = writeln!(text, "\nrate of phase-space volume: {volume} 1/s{system}");
    if let Some(defect) = defects.symplecticity {
        let _ = writeln!(text, "defect of symplecticity: {}", rounded(defect));
    }
    if let Some(defect) = defects.reversibility {
        let halved = beside("with half the step", defects.reversibility_halved);
        let _ = writeln!(text, "defect of reversibility: {}{halved}", rounded(defect));
    }
    if let Some(energy) = &defects.energy {
        let _ = writeln!(
            text,
            "energy: {} 1/s over {}; {}",
            rounded(energy.rate),
            plural(energy.steps, "step"),
            energy.reason.text()
        );
    }
}

fn integrator(report: &ProbeReport, text: &mut String) {
    let (Some(order), Some(recognition)) = (&report.order, &report.recognition) else { return };
    let _ = match order.is_exact {
        true => writeln!(text, "\norder by halved steps: none, the step is exact"),
        false => writeln!(text, "\norder by halved steps: {}", order.in_words()),
    };
    let all = [
        ("by results", Some(&recognition.by_results)),
        ("by matrix", recognition.by_matrix.as_ref()),
    ];
    for (by, found) in all {
        let Some(found) = found else { continue };
        let _ = writeln!(text, "{:<32} {:>12}", format!("integrator, {by}"), "distance");
        // The rest is on the page.
        for candidate in found.candidates.iter().take(4) {
            let agrees = match found.agreement(candidate.method) {
                "yes" => "agrees",
                "no" => "",
                unknown => unknown,
            };
            let _ = writeln!(
                text,
                "{}",
                format!(
                    "  {:<30} {:>12} {agrees}",
                    candidate.method,
                    number(candidate.distance, 3)
                )
                .trim_end()
            );
        }
    }
}
