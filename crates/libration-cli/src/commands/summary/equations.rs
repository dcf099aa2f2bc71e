//! Steps of a system by equations.

use libration_analyze::equation_analysis::{EquationAnalysis, EquationMotion, MotionSteps};
use libration_analyze::linear_analysis::StepAnalysis;
use libration_report::verdict::Verdict;
use libration_settings::linear_loop::OperatingPoint;

use super::super::digits::{limit, significant};
use super::super::repeat_command::{SYSTEM, of_subcommand, with_option};
use super::linear_plant::verdict;
use super::linear_steps::append_steps;
use super::motion::{energy_change, sentence};
use super::step::in_words;
use super::{Summary, numbers, words};

/// Largest number of states.
const MOST: usize = 6;

/// Returns a screen of an analysis; `order` is the order of the steps in words.
pub(crate) fn of_equations(analysis: &EquationAnalysis, order: &str) -> String {
    let EquationAnalysis { system, motion, .. } = analysis;
    let mut summary = Summary::new(&verdicts_in_words(analysis));
    if let Some(reason) = &analysis.no_modes {
        summary.wrap("", &format!("warning: no modes: {reason}"), 2);
    }
    append_errors(motion, &mut summary);
    summary.blank();
    summary.row("order", order);
    append_energy(motion, &mut summary);
    if let Some(radius) = motion.spectral_radius {
        let excess =
            |x: f64| format!("1 {} {}", if x < 0.0 { "−" } else { "+" }, significant(x.abs(), 5));
        let slowest = analysis.linear.as_ref().and_then(|linear| linear.modes.first());
        let exact = slowest.map(|mode| excess((mode.growth_rate * motion.dt).exp_m1()));
        let exact = exact.map_or_else(String::new, |exact| format!(", {exact} of exact steps"));
        let shown = format!("{} at the equilibrium{exact}", excess(radius - 1.0));
        summary.row("spectral radius", &shown);
    }
    if let Some(linear) = &analysis.linear {
        append_steps(linear, false, &mut summary);
    }
    summary.row("along the motion", &along_motion(&analysis.steps_along_motion, motion));
    let point = analysis.operating_point.as_ref().map(OperatingPoint::sentence);
    let plant = analysis.linear.as_ref().map(verdict);
    let sentences: Vec<String> = point.into_iter().chain(plant).collect();
    if !sentences.is_empty() {
        summary.sentence(&sentences.join(" "));
    }
    let horizon = significant(motion.error_steps as f64 * motion.dt, 4);
    let more = ["--tolerance", "trajectory=1e-6", "--horizon", &horizon];
    match is_good(analysis) {
        true => summary.command(
            "Find the cheapest integrator for an error",
            &of_subcommand("advise", &SYSTEM, &more),
        ),
        false => {
            let dt = significant(shorter(analysis), 6);
            summary.command("Take shorter steps", &with_option("--dt", &dt));
        }
    }
    let system = format!("the operations of a step, all states of {}, and the modes", system.name);
    summary.finish(&system)
}

/// The largest stable step along the motion in words.
pub(crate) fn along_motion(steps: &MotionSteps, motion: &EquationMotion) -> String {
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

/// Half of the step, or of the largest stable one at the equilibrium and along the motion.
fn shorter(analysis: &EquationAnalysis) -> f64 {
    let EquationAnalysis { motion, linear, .. } = analysis;
    let own = |step: &&StepAnalysis| step.integrator == motion.integrator;
    let step = linear.as_ref().and_then(|linear| linear.steps.iter().find(own));
    let end = step.and_then(|step| step.stable_dt.as_deref()?.first()?[1]);
    let along = analysis.steps_along_motion.largest_stable_dt;
    let limits = [end, along].into_iter().flatten().filter(|limit| *limit > 0.0);
    0.5 * limits.fold(motion.dt, f64::min)
}

/// The first sentence is about an instability of the step, if there is one, else about the motion.
fn verdicts_in_words(analysis: &EquationAnalysis) -> String {
    let EquationAnalysis { system, motion, verdicts, .. } = analysis;
    let step = format!("{} in steps of {} s", motion.integrator, significant(motion.dt, 6));
    let scope = format!(" on {}", system.name);
    let own = verdicts.step.as_ref();
    let of_step = own.filter(|_| verdicts.is_unstable() || verdicts.motion.is_none());
    let of_step = of_step.map(|verdict| in_words(&step, &step, &scope, verdict));
    let Some(of_motion) = &verdicts.motion else { return of_step.unwrap_or_default() };
    let subject = if of_step.is_some() { "It".to_owned() } else { step + &scope };
    let of_motion = sentence(&subject, of_motion, &motion.examination, motion.dt);
    let of_step = of_step.map_or_else(String::new, |text| text + " ");
    of_step + &of_motion.replace("Whether It", "Whether it")
}

/// Whether all verdicts are good.
fn is_good(analysis: &EquationAnalysis) -> bool {
    analysis.verdicts.all().all(Verdict::is_good)
}

fn append_errors(motion: &EquationMotion, summary: &mut Summary) {
    let states = motion.examination.states.iter().zip(&motion.errors);
    let rows: Vec<Vec<String>> = states
        .take(MOST)
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

fn append_energy(motion: &EquationMotion, summary: &mut Summary) {
    match &motion.energy {
        Some(energy) => summary.row("energy", &energy_change(energy)),
        None => summary.row("energy", "the file has none, so its drift is not known"),
    }
}

fn predicted(motion: &EquationMotion) -> String {
    motion.predicted_reduction.map_or_else(|| "-".to_owned(), |least| format!("{least:.0} or more"))
}
