//! Steps of an integrator on a system.

use libration_analyze::{
    Analysis, MotionSteps, Request, StepMatrix, SteppedMotion, SystemSummary, change_per_step,
};
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::linear_loop::OperatingPoint;

use super::super::digits::{UNKNOWN, limit, short, significant};
use super::linear_plant::verdict;
use super::linear_steps::{append_predictions, append_steps};
use super::motion::{energy_change, sentence};
use super::next_step::next;
use super::step_loop::append_loop;
use super::{Summary, numbers, words};

/// Largest number of windows of stable steps.
const MOST_WINDOWS: usize = 3;

/// Largest number of states.
const MOST_STATES: usize = 6;

/// Largest number of parameters behind the name of a system.
const MOST_PARAMETERS: usize = 3;

/// Returns a screen of an analysis; `order` is the order of the steps in words.
pub(crate) fn of_analysis(analysis: &Analysis, request: &Request, order: Option<&str>) -> String {
    let of_loop = analysis.verdicts.closed_loop.as_ref();
    let mut summary = match of_loop {
        Some(verdict) => Summary::new(&in_words("The loop", "the loop", "", verdict)),
        None => Summary::new(&verdicts_in_words(analysis)),
    };
    if let (Some(_), Some(matrix)) = (of_loop, &analysis.matrix) {
        let at = if request.system.is_linear() { "" } else { "linearised at the start, " };
        summary.sentence(&format!("Without feedback: {at}motions {}.", growth(matrix)));
    }
    if let Some(note) = &analysis.note {
        summary.wrap("", &format!("note: {note}"), 2);
    }
    if let Some(motion) = &analysis.motion {
        append_errors(motion, &mut summary);
    }
    summary.blank();
    if let Some(timing) = &analysis.timing {
        append_loop(timing, &request.timing, request.dt, &mut summary);
    }
    append_limits(analysis, request, &mut summary);
    if let Some(order) = order {
        summary.row("order", order);
    }
    // The linearised step of a nonlinear system belongs to its start alone.
    if let (Some(matrix), true) = (&analysis.matrix, request.system.is_linear()) {
        let phase = match matrix.phase_error_per_step {
            Some(error) => format!("{} rad per step", significant(error, 4)),
            None => no_phase_error(matrix).to_owned(),
        };
        summary.row("phase error", &phase);
        let evaluations = matrix.force_evaluations_per_step;
        summary.row("force evaluations", &format!("{evaluations} per step"));
    }
    append_energy(analysis, &mut summary);
    append_equilibrium(analysis, &mut summary);
    if let Some((purpose, command)) = next(analysis, request) {
        summary.command(purpose, &command);
    }
    summary.finish("the matrix of a step, its defects and operations, all states, and the modes")
}

/// A verdict as a sentence about `subject`, which is `inside` of a sentence.
pub(super) fn in_words(subject: &str, inside: &str, scope: &str, verdict: &Verdict) -> String {
    let Verdict { outcome, evidence, .. } = verdict;
    match outcome {
        Outcome::Unknown => {
            format!("Whether {inside} is stable{scope} is not known: {evidence}.")
        }
        Outcome::NotResolved => {
            format!("{subject} does not resolve the motion{scope}: {evidence}.")
        }
        outcome => format!("{subject} is {outcome}{scope}: {evidence}."),
    }
}

/// A system with its parameters, if they are few.
pub(in crate::commands) fn named(system: &SystemSummary) -> String {
    let parameters = system.parameters.iter();
    let all: Vec<String> =
        parameters.map(|own| format!("{} = {}", own.name, short(own.value))).collect();
    match (1..=MOST_PARAMETERS).contains(&all.len()) {
        true => format!("{} ({})", system.name, all.join(", ")),
        false => system.name.clone(),
    }
}

/// The verdicts on the step and on the motion.
fn verdicts_in_words(analysis: &Analysis) -> String {
    let Analysis { motion, verdicts, .. } = analysis;
    let step = format!("{} in steps of {} s", analysis.integrator, significant(analysis.dt, 6));
    let scope = format!(" on {}", named(&analysis.system));
    // A stable step says little of a motion that stays away from the equilibrium.
    let is_said = |_: &&Verdict| {
        verdicts.is_unstable() || verdicts.motion.is_none() || analysis.stability_windows.is_some()
    };
    let of_step = verdicts.step.as_ref().filter(is_said);
    let of_step = of_step.map(|verdict| in_words(&step, &step, &scope, verdict));
    let (Some(own), Some(motion)) = (&verdicts.motion, motion) else {
        let nothing = || format!("{step}{scope}: there is no verdict.");
        return of_step.unwrap_or_else(nothing);
    };
    let subject = if of_step.is_some() { "It".to_owned() } else { step + &scope };
    let of_motion = sentence(&subject, own, &motion.examination, motion.dt);
    let of_step = of_step.map_or_else(String::new, |text| text + " ");
    of_step + &of_motion.replace("Whether It", "Whether it")
}

/// How motions grow in steps without feedback.
fn growth(matrix: &StepMatrix) -> String {
    let [own, exact] = [matrix.spectral_radius_minus_one, matrix.flow_spectral_radius_minus_one]
        .map(change_per_step);
    format!("{own}, and those of exact steps {exact}")
}

/// The windows of stable steps and the largest steps for criteria.
fn append_limits(analysis: &Analysis, request: &Request, summary: &mut Summary) {
    if let Some(windows) = &analysis.stability_windows {
        let end = |x: Option<f64>| x.map_or("∞".into(), |x| limit(x, 6));
        let shown = windows.iter().take(MOST_WINDOWS);
        let mut shown: Vec<String> =
            shown.map(|&[from, to]| format!("{} to {}", end(from), end(to))).collect();
        if windows.len() > MOST_WINDOWS {
            shown.push(format!("{} more windows", windows.len() - MOST_WINDOWS));
        }
        let shown = if shown.is_empty() { "none".into() } else { shown.join(", ") };
        summary.row("stable for dt in s", &shown);
    }
    let mut largest = |what: &str, of: Option<f64>, dt: Option<Option<f64>>| {
        let Some(of) = of else { return };
        let dt = match dt {
            Some(Some(dt)) => limit(dt, 6),
            Some(None) => "any".to_owned(),
            None => UNKNOWN.to_owned(),
        };
        summary.row("largest dt in s", &format!("{dt} for {what} {}", short(of)));
    };
    if let Some(dt) = &analysis.largest_dt {
        let criteria = &request.criteria;
        largest("drift", criteria.max_drift, dt.energy_drift);
        largest("drift from the worst start", criteria.max_drift, dt.energy_drift_worst_start);
        largest("amplitude", criteria.max_amplitude, dt.amplitude);
        largest("error", criteria.max_error, dt.trajectory_error);
    }
}

/// The drift of an oscillator in all steps, or the change of the energy in the steps of the motion.
fn append_energy(analysis: &Analysis, summary: &mut Summary) {
    if let Some(drift) = &analysis.drift {
        let size = match drift.max_energy_drift.get() {
            // The rounding of 1024 bits.
            size if exponent(size) < -200 => "0".to_owned(),
            size => few_digits(size),
        };
        let at = format!("step {} of {}", drift.max_energy_drift_step, analysis.steps);
        return summary.row("energy drift", &format!("{size} of the start, at {at} (exact)"));
    }
    match analysis.motion.as_ref().map(|motion| &motion.energy) {
        Some(Some(energy)) => summary.row("energy", &energy_change(energy)),
        Some(None) => summary.row("energy", "the system has none, so its drift is not known"),
        None => {}
    }
}

/// The step at the equilibrium near the start and along the motion.
fn append_equilibrium(analysis: &Analysis, summary: &mut Summary) {
    let Some(about) = &analysis.equilibrium else { return };
    let radius = analysis.motion.as_ref().and_then(|motion| motion.spectral_radius);
    // The first sentence has that of an oscillator.
    if let (Some(radius), None) = (radius, &analysis.stability_windows) {
        let excess =
            |x: f64| format!("1 {} {}", if x < 0.0 { "−" } else { "+" }, significant(x.abs(), 5));
        let slowest = about.linear.as_ref().and_then(|linear| linear.modes.first());
        let exact = slowest.map(|mode| excess((mode.growth_rate * analysis.dt).exp_m1()));
        let exact = exact.map_or_else(String::new, |exact| format!(", {exact} of exact steps"));
        let shown = format!("{} at the equilibrium{exact}", excess(radius - 1.0));
        summary.row("spectral radius", &shown);
    }
    if let Some(linear) = &about.linear {
        match analysis.stability_windows {
            Some(_) => append_predictions(&linear.steps, summary),
            None => append_steps(linear, false, summary),
        }
    }
    // The stable steps of a linear system are the same everywhere.
    let varies = analysis.system.polynomial_degree.is_none_or(|degree| degree > 1);
    let along = analysis.steps_along_motion.as_ref().filter(|_| varies);
    if let (Some(motion), Some(steps)) = (&analysis.motion, along) {
        summary.row("along the motion", &along_motion(steps, motion));
    }
    let point = about.operating_point.as_ref().map(OperatingPoint::sentence);
    let plant = about.linear.as_ref().map(verdict);
    let reason = about.no_modes.as_ref().map(|reason| format!("No modes: {reason}."));
    let sentences: Vec<String> = point.into_iter().chain(plant).chain(reason).collect();
    if !sentences.is_empty() {
        summary.sentence(&sentences.join(" "));
    }
}

/// The largest stable step along the motion in words.
pub(crate) fn along_motion(steps: &MotionSteps, motion: &SteppedMotion) -> String {
    let until = significant(steps.until, 4);
    let about = format!("estimate of {} states", steps.states);
    let unknown = match steps.unknown_states {
        0 => String::new(),
        count => format!("; not known at {count} of them"),
    };
    match steps.largest_stable_dt {
        _ if steps.unknown_states == steps.states => {
            format!("stable steps are not known at any of {} states up to {until} s", steps.states)
        }
        Some(0.0) => {
            format!("no step is stable at {} s ({about}{unknown})", significant(steps.at_time, 3))
        }
        Some(dt) => {
            let exceeds = if motion.dt > dt { "; dt exceeds it" } else { "" };
            format!(
                "stable up to {} s, at {} s ({about}{unknown}){exceeds}",
                limit(dt, 4),
                significant(steps.at_time, 3)
            )
        }
        None => format!("no limit of stable steps up to {until} s ({about}{unknown})"),
    }
}

fn append_errors(motion: &SteppedMotion, summary: &mut Summary) {
    let states = motion.examination.states.iter().zip(&motion.errors);
    let rows: Vec<Vec<String>> = states
        .take(MOST_STATES)
        .map(|(state, halved)| {
            let name = match state.unit.as_str() {
                "" => state.name.clone(),
                unit => format!("{} ({unit})", state.name),
            };
            vec![
                name,
                significant(state.range, 4),
                significant(state.largest_error, 2),
                halved.reduction.map_or_else(|| "-".to_owned(), |x| significant(x, 4)),
                predicted(motion),
                if state.resolved { "" } else { "not resolved" }.to_owned(),
            ]
        })
        .collect();
    let heads = [
        words("state"),
        numbers("size of motion"),
        numbers("largest error"),
        numbers("halved steps reduce by"),
        numbers("predicted"),
        words(""),
    ];
    summary.blank();
    summary.table(&heads, &rows);
    summary.rest(motion.errors.len() - rows.len());
}

fn predicted(motion: &SteppedMotion) -> String {
    motion.predicted_reduction.map_or_else(|| "-".to_owned(), |least| format!("{least:.0} or more"))
}

/// Why there is no phase error.
pub(crate) fn no_phase_error(matrix: &StepMatrix) -> &'static str {
    match matrix.loses_oscillation {
        true => "none: a step is too long to follow the oscillation",
        false => "none: nothing oscillates",
    }
}

/// A decimal with four digits, also beyond the range of floats.
fn few_digits(decimal: &str) -> String {
    match (decimal.parse::<f64>(), decimal.split_once('e')) {
        (Ok(x), _) if x.is_finite() => significant(x, 4),
        (_, Some((mantissa, exponent))) => {
            format!("{}e{exponent}", significant(mantissa.parse().unwrap_or(f64::NAN), 4))
        }
        _ => decimal.to_owned(),
    }
}

/// The decimal exponent of a number in digits.
fn exponent(number: &str) -> i64 {
    number.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}
