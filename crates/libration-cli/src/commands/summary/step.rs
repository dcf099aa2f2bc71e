//! One step of a system of the catalogue.

use libration_analyze::{Analysis, Request, StepMatrix, Stepping, change_per_step};
use libration_report::verdict::{Outcome, Verdict};

use super::super::digits::{UNKNOWN, limit, short, significant};
use super::super::repeat_command::{SYSTEM, of_subcommand, with_option};
use super::Summary;
use super::motion::{energy_change, sentence};
use super::step_loop::append_loop;

/// Largest number of windows of stable steps.
const MOST: usize = 3;

/// Returns a screen of an analysis.
pub(crate) fn of_step(analysis: &Analysis, request: &Request) -> String {
    let of_loop = analysis.verdicts.closed_loop.as_ref();
    let is_loop = of_loop.is_some();
    let mut summary = match of_loop {
        Some(verdict) => Summary::new(&in_words("The loop", "the loop", "", verdict)),
        None => Summary::new(&first_sentence(analysis)),
    };
    if is_loop || analysis.verdicts.motion.is_some() {
        summary.sentence(&growth(analysis, is_loop));
    }
    if let Some(step) = analysis.drift.as_ref().and_then(|drift| drift.stopped_at_step) {
        summary.warnings(&[format!("the state leaves the range of f64 at step {step}")]);
    }
    if let Some(note) = &analysis.request.note {
        summary.wrap("", &format!("note: {note}"), 2);
    }
    summary.blank();
    if let Some(timing) = &analysis.timing {
        append_loop(timing, &request.timing, request.dt, &mut summary);
    }
    append_step(analysis, request, &mut summary);
    if let Some((purpose, command)) = next(analysis, is_loop) {
        summary.command(purpose, &command);
    }
    let more = "the update matrix and its polynomials, eigenvalues, defects of symplecticity and reversibility";
    summary.finish(more)
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

/// The verdict on the step, or of a nonlinear system on the motion.
fn first_sentence(analysis: &Analysis) -> String {
    let about = &analysis.request;
    let step = format!("{} in steps of {} s", about.integrator, short(about.dt));
    let parameters: Vec<String> = about
        .parameters
        .iter()
        .map(|(name, value)| format!("{name} = {}", short(*value)))
        .collect();
    let system = format!("{} ({})", about.system, parameters.join(", "));
    match (&analysis.verdicts.step, &analysis.verdicts.motion, &analysis.motion) {
        (Some(verdict), Some(own), Some(motion)) => {
            let of_motion = |subject: &str| sentence(subject, own, motion, about.dt);
            let on = format!(" on {system}");
            match verdict.outcome {
                Outcome::Unstable => {
                    in_words(&step, &step, &on, verdict)
                        + " "
                        + &of_motion("It").replace("Whether It", "Whether it")
                }
                _ => of_motion(&(step + &on)),
            }
        }
        (Some(verdict), ..) => in_words(&step, &step, &format!(" on {system}"), verdict),
        (None, Some(verdict), Some(motion)) => {
            sentence(&format!("{step} on {system}"), verdict, motion, about.dt)
        }
        _ => format!("{step} on {system}: {}", growth(analysis, false)),
    }
}

/// How motions grow in steps without feedback.
fn growth(analysis: &Analysis, is_loop: bool) -> String {
    let [own, exact] =
        [analysis.matrix.spectral_radius_minus_one, analysis.matrix.flow_spectral_radius_minus_one]
            .map(change_per_step);
    let at = if analysis.request.linear { "" } else { "Linearised at the start, " };
    let without = if is_loop { "Without feedback: " } else { "" };
    let motions = if at.is_empty() && !is_loop { "Motions" } else { "motions" };
    format!("{without}{at}{motions} {own}, and those of exact steps {exact}.")
        .replace(": Linearised", ": linearised")
}

fn append_step(analysis: &Analysis, request: &Request, summary: &mut Summary) {
    let about = &analysis.request;
    let one_mode = matches!(&*about.system, "oscillator" | "damped-oscillator");
    match &analysis.stability_windows {
        Some(windows) => {
            let end = |x: Option<f64>| x.map_or("∞".into(), |x| limit(x, 6));
            let shown = windows.iter().take(MOST);
            let mut shown: Vec<String> =
                shown.map(|&[from, to]| format!("{} to {}", end(from), end(to))).collect();
            if windows.len() > MOST {
                shown.push(format!("{} more windows", windows.len() - MOST));
            }
            let shown = if shown.is_empty() { "none".into() } else { shown.join(", ") };
            summary.row("stable for dt in s", &shown);
        }
        None if one_mode && about.integrator != Stepping::EXACT => {
            summary.row("stable for dt in s", UNKNOWN);
        }
        None => {}
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
    if let Some(word) = &analysis.order_of_word {
        summary.row("order", &word.order.to_string());
    }
    let phase = match analysis.matrix.phase_error_per_step {
        Some(error) => format!("{} rad per step", significant(error, 4)),
        None => no_phase_error(&analysis.matrix).to_owned(),
    };
    summary.row("phase error", &phase);
    summary.row(
        "force evaluations",
        &format!("{} per step", analysis.matrix.force_evaluations_per_step),
    );
    let of_motion = analysis.motion.as_ref().and_then(|motion| motion.energy.as_ref());
    if let Some(energy) = of_motion {
        return summary.row("energy", &energy_change(energy));
    }
    let drift = match &analysis.drift {
        None => "undefined: the energy at the start is zero".to_owned(),
        Some(drift) => {
            let size = match drift.max_energy_drift.get() {
                "null" => "beyond the range of f64; more than any part".to_owned(),
                // The rounding of 1024 bits.
                size if exponent(size) < -200 => "0".to_owned(),
                size => few_digits(size),
            };
            format!(
                "{size} of the start, at step {} of {} ({})",
                drift.max_energy_drift_step, about.steps, drift.max_energy_drift_method
            )
        }
    };
    summary.row("energy drift", &drift);
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

/// The recommended command and its purpose.
fn next(analysis: &Analysis, is_loop: bool) -> Option<(&'static str, String)> {
    let about = &analysis.request;
    if is_loop {
        let timing = analysis.timing.as_ref()?;
        let late = timing.latency_steps? * about.dt;
        let critical = timing.critical.as_ref()?.critical_latency_seconds;
        return Some(match critical.filter(|critical| *critical <= late && *critical > 0.0) {
            Some(critical) => {
                // Below it: at the limit itself the loop does not decay.
                ("Take a shorter latency", with_option("--latency", &limit(0.9 * critical, 2)))
            }
            None => {
                let period = format!("{}", about.dt);
                let options =
                    [&SYSTEM[..], &["--feedback", "--latency", "--jitter", "--loss"]].concat();
                let command = of_subcommand("advise", &options, &["--period", &period]);
                ("Find the limits of each imperfection", command)
            }
        });
    }
    let is_good = analysis.verdicts.step.as_ref().is_some_and(Verdict::is_good);
    // Nothing moves there, so that no error has a size.
    let rests = about.parameters.get("omega2") == Some(&0.0) && about.v.iter().all(|v| *v == 0.0);
    match (analysis.bounded, &analysis.stability_windows) {
        (Some(false), Some(windows)) if !is_good => match windows.first() {
            Some(&[Some(0.0), Some(to)]) if about.dt > to => {
                Some(("Take shorter steps", with_option("--dt", &limit(0.9 * to, 2))))
            }
            Some(_) => None,
            None if about.integrator == "velocity-verlet" => None,
            None => Some((
                "Take an integrator that is stable",
                with_option("--integrator", "velocity-verlet"),
            )),
        },
        _ if rests => None,
        // `advise` has systems of at most two degrees of freedom.
        _ if about.q.len() <= 2 => Some((
            "Find the cheapest integrator for an error",
            of_subcommand("advise", &SYSTEM, &["--tolerance", "trajectory=1e-3"]),
        )),
        _ => None,
    }
}

/// The decimal exponent of a number in digits.
fn exponent(number: &str) -> i64 {
    number.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}
