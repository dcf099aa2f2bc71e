//! An identification as text.

use std::fmt::Write as _;

use libration_identify::{Identification, interval, with_unit};
use libration_report::notation::number;

/// The result as text.
pub(super) fn describe(found: &Identification) -> String {
    let mut text = format!("{}\n", found.answer);
    for warning in &found.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    let _ = writeln!(text, "verdict: {}", found.verdict);
    // Numbers of a response that does not depend on the command mean nothing.
    if !found.depends_on_command {
        let _ = writeln!(text, "repeat with: {}", found.repeat_command);
        return text;
    }
    let head = if found.has_intervals() { "   95 % interval" } else { "" };
    let _ = writeln!(text, "\n{:<32} {:>14}{head}", "number", "estimate");
    for parameter in &found.parameters {
        let value = with_unit(parameter.value, &parameter.unit);
        let row = format!("{:<32} {value:>14}   {}", parameter.name, interval(parameter));
        let _ = writeln!(text, "{}", row.trim_end());
    }
    if let Some(correlation) = found.correlation.filter(|_| found.has_intervals()) {
        let _ = writeln!(
            text,
            "\nthe errors of dead time and lag have the correlation {correlation:.2} with this command"
        );
        excitations(found, &mut text);
    }
    if let Some([low, high]) = found.delay_range {
        let _ = writeln!(
            text,
            "\nrange of action_delay for randomisation: {} to {}",
            with_unit(low, "s"),
            with_unit(high, "s")
        );
    }
    let tests = &found.residuals;
    let _ = writeln!(
        text,
        "\nresiduals: independent p = {}, of earlier commands p = {}, feedback p = {}",
        number(tests.whiteness, 2),
        number(tests.command, 2),
        number(tests.feedback, 2)
    );
    let _ = writeln!(
        text,
        "\n{:<16} {:<8} {:<12} {:<12} {:>12} {:>12} {:>24}",
        "response", "hold", "noise", "arrivals", "dead time", "lag", "excess of Bayes' criterion"
    );
    for row in found.candidates.iter().take(5) {
        let _ = writeln!(
            text,
            "{:<16} {:<8} {:<12} {:<12} {:>12} {:>12} {:>24}",
            row.response,
            row.hold.name(),
            row.noise.name(),
            row.arrivals,
            with_unit(row.dead_time, "s"),
            row.second.map_or_else(|| "-".to_owned(), |second| with_unit(second, "s")),
            number(row.excess, 4)
        );
    }
    for row in found.bootstrap.iter().filter(|_| found.has_intervals()) {
        let unit = found.parameter(&row.key).map_or("", |parameter| &*parameter.unit);
        let _ = writeln!(
            text,
            "simulated logs: {:<16} {} to {}{}",
            row.key,
            with_unit(row.low, unit),
            with_unit(row.high, unit),
            row.ratio.map_or_else(String::new, |ratio| format!(
                "; {} times the standard error of Fisher's information",
                number(ratio, 3)
            )),
        );
    }
    let _ = writeln!(text, "repeat with: {}", found.repeat_command);
    text
}

/// The command that would tell most.
fn excitations(found: &Identification, text: &mut String) {
    let own = found.excitations.first().and_then(|row| row.dead_time_error);
    let others = found.excitations.iter().skip(1).filter(|row| row.dead_time_error.is_some());
    let best = others.min_by(|a, b| {
        let error = |row: &libration_identify::ExcitationRow| {
            let [first, second] = [row.dead_time_error, row.lag_error];
            first.unwrap_or(f64::INFINITY) + second.unwrap_or(0.0)
        };
        error(a).total_cmp(&error(b))
    });
    let (Some(own), Some(best)) = (own, best) else { return };
    if let Some(error) = best.dead_time_error.filter(|&error| error < 0.8 * own) {
        let _ = writeln!(
            text,
            "with {} of the same size the standard error of the dead time would be {}, in place of {}",
            best.command,
            with_unit(error, "s"),
            with_unit(own, "s")
        );
    }
}
