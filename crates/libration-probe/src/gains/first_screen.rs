//! The first screen of a page about gains: its verdict, its numbers, what is used of each limit, and what to do.

use libration_report::notation::{cut_off, number};
use libration_report::page::{Bar, Highlight};
use libration_report::verdict::Outcome;

use super::command_option::{is_command, with_flag, with_option};
use super::{GainReport, MeasuredGains, Torque};

/// Joints whose limits are shown as bars, the tightest first.
const MOST_BARS: usize = 6;

/// The verdict.
pub(super) fn title(report: &GainReport) -> &'static str {
    match (report.growth_in_continuous_time, report.verdict.outcome) {
        (_, Outcome::Unknown) => "Whether the gains hold is unknown",
        (Some(_), _) => "The motion is unstable in continuous time, whatever the step",
        (None, _) if report.holds => "The gains hold",
        (None, _) if !has_servos(report) => "The step is unstable",
        (None, _) if report.unstable_without_servos && report.others.remaining().is_some() => {
            "The step is unstable without gains of the servos"
        }
        (None, _) if report.unstable_without_servos => "The step is unstable without any servo",
        (None, _) => "The gains do not hold",
    }
}

fn has_servos(report: &GainReport) -> bool {
    report.measured.as_ref().is_none_or(MeasuredGains::has_servos)
}

/// The key numbers.
pub(super) fn numbers(report: &GainReport) -> Vec<Highlight> {
    let mut shown = vec![Highlight {
        value: number(report.spectral_radius, 5),
        text: format!(
            "largest factor of a mode in {} s{}",
            number(length(report), 4),
            exact_radius(report)
                .map_or_else(String::new, |exact| format!("; {} in exact steps", number(exact, 5)))
        ),
    }];
    if report.largest_factor.is_finite() && report.largest_factor > 0.0 {
        shown.push(Highlight {
            value: number(cut(report.largest_factor), 4),
            text: "largest common factor of all gains of position".into(),
        });
    }
    if let Some(gain) = limited(report).first() {
        shown.push(Highlight {
            value: number(cut(gain.largest), 4),
            text: format!("largest kp of {}; given {}", gain.of, number(gain.kp, 4)),
        });
    }
    if let Some(fewest) = report.fewest_substeps {
        shown.push(Highlight {
            value: fewest.to_string(),
            text: format!("fewest substeps that hold the gains; given {}", report.substeps),
        });
    }
    shown
}

/// The time in which modes have the factors of a report, in s: a substep, or a step of the servo model if that holds the torques.
pub(super) fn length(report: &GainReport) -> f64 {
    match report.torque {
        Torque::Held if report.measured.is_none() => report.dt,
        _ => report.dt / f64::from(report.substeps),
    }
}

/// The largest factor of a mode in an exact step of the same length; none if a mode has no damping ratio.
fn exact_radius(report: &GainReport) -> Option<f64> {
    if let Some(measured) = &report.measured {
        let h = length(report);
        let all: Option<Vec<f64>> =
            measured.modes.iter().map(|mode| Some((mode.flow?.growth_rate * h).exp())).collect();
        return all?.into_iter().reduce(f64::max);
    }
    let of_mode = |turn: f64, ratio: Option<f64>| {
        let ratio = ratio?;
        // Beyond critical damping the slower of the two decays counts.
        let slowest = ratio - (ratio * ratio - 1.0).max(0.0).sqrt();
        Some((-slowest * turn).exp())
    };
    let all: Option<Vec<f64>> =
        report.modes.iter().map(|mode| of_mode(mode.turn, mode.damping_ratio)).collect();
    all?.into_iter().reduce(f64::max)
}

/// The used part of the largest gain of each joint or servo.
pub(super) fn bars(report: &GainReport) -> Vec<Bar> {
    let bar = |gain: &LimitedGain<'_>| Bar {
        name: gain.of.to_owned(),
        part: gain.kp / gain.largest,
        text: format!("kp {} of {}", number(gain.kp, 4), number(cut(gain.largest), 4)),
    };
    limited(report).iter().take(MOST_BARS).map(bar).collect()
}

/// A gain of position with a limit.
struct LimitedGain<'a> {
    /// The joint of a servo model, or the servo of a measured step.
    of: &'a str,
    kp: f64,
    largest: f64,
}

/// The gains of position that have a limit, the tightest first. In a measured step each servo has a limit of its own, and the gain of a
/// joint has more than that of its servo: stiffness, and other servos.
fn limited(report: &GainReport) -> Vec<LimitedGain<'_>> {
    let all: Vec<LimitedGain<'_>> = match &report.measured {
        Some(measured) => measured
            .servos
            .iter()
            .map(|own| LimitedGain { of: &own.name, kp: own.kp, largest: own.largest_kp })
            .collect(),
        None => report
            .joints
            .iter()
            .map(|own| LimitedGain { of: &own.name, kp: own.kp, largest: own.largest_kp })
            .collect(),
    };
    let has_limit =
        |gain: &LimitedGain<'_>| gain.kp > 0.0 && gain.largest.is_finite() && gain.largest > 0.0;
    let mut found: Vec<LimitedGain<'_>> = all.into_iter().filter(has_limit).collect();
    found.sort_by(|a, b| (a.largest / a.kp).total_cmp(&(b.largest / b.kp)));
    found
}

/// What to do.
pub(super) fn actions(report: &GainReport) -> Vec<String> {
    let command = &report.repeat_command;
    if report.growth_in_continuous_time.is_some() {
        return vec![
            "Change the gains or the stiffnesses: no step makes this motion stable.".into(),
        ];
    }
    let mut all = Vec::new();
    if report.verdict.outcome == Outcome::Unknown && report.is_inert() {
        return vec!["Examine a point at which all servos act within their force limits.".into()];
    }
    if report.is_withheld {
        return report.others.actions();
    }
    if report.verdict.outcome == Outcome::Unknown && report.measured.is_none() {
        all.push("Add damping or take another integrator: rounding decides with this one.".into());
        return all;
    }
    let is_unknown = report.verdict.outcome == Outcome::Unknown;
    if is_unknown && report.measured.as_ref().is_some_and(MeasuredGains::is_at_rest) {
        all.push("Choose positive gains of position, or add stiffness or damping: what moves so slowly is not measured.".into());
        return all;
    }
    if report.verdict.outcome == Outcome::Unknown {
        let settled = with_flag(command, "--settle");
        all.push(format!("Examine an equilibrium near the point{}", then(settled.as_deref())));
        return all;
    }
    if !report.holds {
        if let Some(fewest) = report.fewest_substeps {
            let changed = with_option(command, "--substeps", &fewest.to_string());
            all.push(format!("Take at least {fewest} substeps{}", then(changed.as_deref())));
        }
        // The first of the table: MuJoCo's Euler, if the gains hold with it.
        if let Some(row) = report.integrators.iter().find(|row| row.holds) {
            let changed = with_option(command, "--integrator", row.name);
            all.push(format!("Step with {}{}", row.title, then(changed.as_deref())));
        }
        if report.largest_factor.is_finite() && report.largest_factor > 0.0 {
            // At the limit itself they do not hold.
            let factor = number(cut(report.largest_factor * (1.0 - 1e-11)), 4);
            all.push(format!(
                "Multiply all gains of position by at most {factor}, which leaves no margin."
            ));
        }
        return all;
    }
    if let Some(gain) = limited(report).first() {
        let most = number(cut(gain.largest), 4);
        all.push(format!("Keep kp of {} below {most}, with all others as they are.", gain.of));
    }
    if is_command(command) {
        all.push(format!("Repeat the report after each change of a gain: `{command}`"));
    }
    all
}

fn then(command: Option<&str>) -> String {
    command.map_or_else(|| ".".into(), |command| format!(": `{command}`"))
}

/// A limit with four digits, not beyond itself.
fn cut(limit: f64) -> f64 {
    cut_off(limit, 4)
}
