//! The loop around a step of a system of the catalogue.

use libration_analyze::{LoopAnalysis, Timing, change_per_step};

use super::super::closed_loop::{CLIPPED, NOMINAL, TOO_FAR, dephasing};
use super::super::digits::{least, limit, significant};
use super::Summary;

/// Largest number of later windows of stable latencies.
const MOST: usize = 3;

/// Appends latencies, growth and cost.
pub(super) fn append_loop(
    analysis: &LoopAnalysis,
    timing: &Timing,
    dt: f64,
    summary: &mut Summary,
) {
    if let (Some([kp, kd]), Some(steps)) = (analysis.feedback, analysis.latency_steps) {
        let [of_kp, of_kd] = analysis.feedback_units.unwrap_or_default();
        let [kp, kd] = [kp, kd].map(|gain| significant(gain, 6));
        let law = format!("-({kp} {of_kp}) q - ({kd} {of_kd}) v");
        let late = significant(steps * dt, 5);
        summary.row(analysis.command.unwrap_or("command"), &format!("{law}, latency {late} s"));
    }
    if let Some(critical) = &analysis.critical {
        let windows = &critical.latency_windows;
        let shown = match (critical.critical_latency_steps, critical.critical_latency_seconds) {
            (Some(steps), Some(seconds)) => {
                format!("{} s, {} steps", limit(seconds, 4), limit(steps, 4))
            }
            _ if windows.iter().any(|(from, _)| *from == 0.0) => "none was found".to_owned(),
            _ => "none: the loop is unstable without latency".to_owned(),
        };
        summary.row("critical latency", &shown);
        let end = |x: Option<f64>| x.map_or("∞".into(), |x| limit(x, 4));
        let again = windows.iter().filter(|(from, _)| *from > 0.0).take(MOST);
        let again: Vec<String> =
            again.map(|&(from, to)| format!("{} to {}", least(from, 4), end(to))).collect();
        if !again.is_empty() {
            summary.row("stable again", &format!("{} steps late", again.join(", ")));
        }
    }
    if let Some(growth) = &analysis.growth {
        let shown = growth.mean_square_growth.map(change_per_step);
        summary.row("second moments", shown.as_deref().unwrap_or(TOO_FAR));
        if analysis.jitter_clips == Some(true) {
            summary.row("", CLIPPED);
        }
        if let Some(exponent) = growth.lyapunov_exponent {
            summary.row("Lyapunov exponent", &format!("{} a step", significant(exponent, 4)));
        }
        if timing.skew.is_some() {
            summary.row("", NOMINAL);
        }
    }
    if let Some(steps) = analysis.dephasing_steps {
        summary.row("mean falls to 1/e in", &dephasing(steps.map(|x| x.round())));
    }
    if let Some(cost) = &analysis.cost {
        let increase = cost.cost_increase.map(|rise| {
            let side = if rise < 0.0 { "below" } else { "above" };
            let percent = significant(100.0 * rise.abs(), 3);
            format!(", {percent} % {side} that of an ideal clock and link")
        });
        let shown = match (cost.cost, cost.cost_infinite) {
            (Some(cost), _) => format!("{} under unit noise", significant(cost, 5)),
            (None, Some(_)) => "infinite: second moments grow".to_owned(),
            (None, None) => "not known: the state of the loop has too many dimensions".to_owned(),
        };
        summary.row("cost", &(shown + &increase.unwrap_or_default()));
    }
}
