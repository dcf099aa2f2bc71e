//! An audit of energies as text.

use std::fmt::Write as _;

use libration_energy::{EnergyReport, PowerLaw, exponent, interval};
use libration_report::notation::number;

/// Returns the report as text.
pub(super) fn describe(report: &EnergyReport) -> String {
    let mut text = format!("{}\n", report.answer);
    for finding in &report.findings {
        let kind = if finding.is_fault { "fault" } else { "warning" };
        let _ = writeln!(text, "{kind}: {}: {}", finding.kind, finding.text);
        let _ = writeln!(text, "help: {}", finding.help);
    }
    runs(report, &mut text);
    let laws = [
        ("oscillation", report.oscillation_law, report.oscillation_cause.text()),
        ("drift rate", report.drift_law, report.drift_cause.text()),
        ("variance of the walk", report.walk_law, report.walk_cause.text()),
    ];
    let _ = writeln!(text, "\n{:<22} {:<30} cause", "part", "exponent of dt");
    for (part, law, cause) in laws {
        let _ = writeln!(text, "{part:<22} {:<30} {cause}", order(law));
    }
    let _ = writeln!(text, "repeat with: {}", report.repeat_command);
    text
}

fn runs(report: &EnergyReport, text: &mut String) {
    let _ = writeln!(
        text,
        "\n{:<20} {:>10} {:>10} {:>34} {:>38} {:>12} {:>12}",
        "run", "dt s", "duration s", "oscillation", "drift per s", "walk in 1 s", "deviation"
    );
    for run in &report.runs {
        let walk = run.walk.filter(|walk| walk.is_present);
        let walk =
            walk.map_or_else(|| "-".to_owned(), |walk| number(walk.diffusion.value.sqrt(), 3));
        let _ = writeln!(
            text,
            "{:<20} {:>10} {:>10} {:>34} {:>38} {:>12} {:>12}",
            run.title,
            number(run.dt, 4),
            number(run.duration, 4),
            interval(run.oscillation, 3),
            interval(run.drift_rate, 3),
            walk,
            number(run.deviation_from_start, 3)
        );
    }
    text.push_str("oscillation, drift, walk and largest deviation from the start are in the unit of the energies\n");
}

fn order(law: Option<PowerLaw>) -> String {
    law.map_or_else(|| "-".to_owned(), |law| exponent(law.exponent))
}
