//! An audit of a step as text.

use std::fmt::Write as _;

use libration_advise::rounded;
use libration_probe::ProbeReport;

/// Returns the report as text.
pub(super) fn describe(report: &ProbeReport) -> String {
    let mut text = format!("{}\n", report.answer);
    for finding in &report.findings {
        let kind = if finding.is_fault { "fault" } else { "warning" };
        let _ = writeln!(text, "{kind}: {}: {}", finding.kind, finding.text);
    }
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    modes(report, &mut text);
    latency(report, &mut text);
    integrator(report, &mut text);
    if let Some(defects) = &report.defects {
        let _ = writeln!(
            text,
            "\nphase-space volume: {} 1/s, of the system {}",
            rounded(defects.volume_rate),
            known(defects.flow_volume_rate)
        );
        let _ = writeln!(
            text,
            "defects: of symplecticity {}, of reversibility {} (with half the step {})",
            known(defects.symplecticity),
            known(defects.reversibility),
            known(defects.reversibility_halved)
        );
        if let Some(energy) = &defects.energy {
            let _ = writeln!(
                text,
                "energy: {} 1/s over {} steps; {}",
                rounded(energy.rate),
                energy.steps,
                energy.reason.text()
            );
        }
    }
    let same = report.bits.checks.iter().filter(|check| check.difference.is_none());
    let names: Vec<&str> = same.map(|check| check.name.as_str()).collect();
    if !names.is_empty() {
        let _ = writeln!(text, "the same bits: {}", names.join("; "));
    }
    if let Some(confirmation) = &report.confirmation {
        let _ = writeln!(
            text,
            "linearised with a relative error of {:.1e}; a run of {} steps follows to {:.1e}",
            report.jacobian_error, confirmation.steps, confirmation.error
        );
    }
    if let Some(reference) = &report.reference {
        let _ = writeln!(
            text,
            "the matrices of {} differ from it by at most {:.1e} of a row",
            reference.source, reference.difference
        );
    }
    let _ = writeln!(text, "repeat with: {}", report.repeat_command);
    text
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
            "{:<36} {:>11.8} {:>12} {:>12} {:>12} {:>12} {:>12}",
            mode.names(),
            mode.radius,
            rounded(mode.step.growth_rate),
            known(flow.map(|flow| flow.growth_rate)),
            rounded(mode.step.frequency),
            known(flow.map(|flow| flow.frequency)),
            known(mode.numerical_damping)
        );
    }
}

fn latency(report: &ProbeReport, text: &mut String) {
    for latency in &report.hidden_latency {
        let by = latency.state.as_deref().unwrap_or("-");
        let _ = writeln!(
            text,
            "\nlatency of {}: {} steps late; the integrator delays it by {} s (phase of {by})",
            latency.input,
            rounded(latency.late_steps),
            known(latency.integrator_delay)
        );
    }
}

fn integrator(report: &ProbeReport, text: &mut String) {
    let (Some(order), Some(recognition)) = (&report.order, &report.recognition) else { return };
    let estimates: Vec<String> = order.estimates.iter().map(|x| format!("{x:.3}")).collect();
    let _ = writeln!(text, "\norder by halved steps: {}", estimates.join(", "));
    let all = [
        ("by results", Some(&recognition.by_results)),
        ("by matrix", recognition.by_matrix.as_ref()),
    ];
    for (by, found) in all {
        let Some(found) = found else { continue };
        let _ = writeln!(text, "{:<32} {:>12}", format!("integrator, {by}"), "distance");
        // The rest is on the page.
        for candidate in found.candidates.iter().take(4) {
            let agrees = if found.methods.contains(&candidate.method) { "agrees" } else { "" };
            let _ = writeln!(
                text,
                "  {:<30} {:>12} {agrees}",
                candidate.method,
                format!("{:.2e}", candidate.distance)
            );
        }
    }
}
