//! Steps of a system by equations.

use libration_analyze::equation_analysis::{EquationAnalysis, EquationMotion, MotionSteps};
use libration_analyze::linear_analysis::StepAnalysis;

use super::super::digits::{limit, significant};
use super::super::repeat_command::{SYSTEM, of_subcommand, with_option};
use super::linear_plant::verdict;
use super::linear_steps::append_steps;
use super::{Summary, numbers, words};

/// Largest number of states.
const MOST: usize = 6;

/// Returns a screen of an analysis; `order` is the order of the steps in words.
pub(crate) fn of_equations(analysis: &EquationAnalysis, order: &str) -> String {
    let EquationAnalysis { system, motion, .. } = analysis;
    let mut summary = Summary::new(&verdict_of_motion(analysis));
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
    if let Some(point) = &analysis.operating_point {
        summary.sentence(&point.sentence());
    }
    if let Some(linear) = &analysis.linear {
        summary.sentence(&verdict(linear));
    }
    let horizon = significant(motion.error_steps as f64 * motion.dt, 4);
    let more = ["--tolerance", "trajectory=1e-6", "--horizon", &horizon];
    match resolves(motion) {
        true => summary.command(
            "Find the cheapest integrator for an error",
            &of_subcommand("advise", &SYSTEM, &more),
        ),
        // Forces with kinks have no order, whatever the step.
        false if system.smooth => {
            let dt = significant(shorter(analysis), 6);
            summary.command("Take shorter steps", &with_option("--dt", &dt));
        }
        false => {}
    }
    let system = format!("the operations of a step, all states of {}, and the modes", system.name);
    summary.finish(&system)
}

/// The largest stable step along the motion in words.
pub(crate) fn along_motion(steps: &MotionSteps, motion: &EquationMotion) -> String {
    let until = significant(steps.until, 4);
    let about = format!("an estimate from {} states up to {until} s", steps.states);
    let unknown = match steps.unknown_states {
        0 => String::new(),
        count => format!("; not known at {count} of them"),
    };
    match steps.largest_stable_dt {
        _ if steps.unknown_states == steps.states => {
            format!("stable steps are not known at any of {} states up to {until} s", steps.states)
        }
        Some(0.0) => {
            format!("no step is stable at {} s, {about}{unknown}", significant(steps.at_time, 3))
        }
        Some(dt) => {
            let exceeds = if motion.dt > dt { "; dt exceeds it" } else { "" };
            format!(
                "stable up to {} s, at {} s, {about}{unknown}{exceeds}",
                limit(dt, 4),
                significant(steps.at_time, 3)
            )
        }
        None => format!("no limit of stable steps, {about}{unknown}"),
    }
}

/// Half of the step, or of the largest stable one.
fn shorter(analysis: &EquationAnalysis) -> f64 {
    let EquationAnalysis { motion, linear, .. } = analysis;
    let own = |step: &&StepAnalysis| step.integrator == motion.integrator;
    let step = linear.as_ref().and_then(|linear| linear.steps.iter().find(own));
    let end = step.and_then(|step| step.stable_dt.as_deref()?.first()?[1]);
    0.5 * end.map_or(motion.dt, |end| end.min(motion.dt))
}

fn verdict_of_motion(analysis: &EquationAnalysis) -> String {
    let EquationAnalysis { system, motion, .. } = analysis;
    let step = format!(
        "{} in steps of {} s on {}",
        motion.integrator,
        significant(motion.dt, 6),
        system.name
    );
    if let Some(diverged) = motion.diverged_at_step {
        return format!("{step} diverges: a state is not finite after step {diverged}.");
    }
    let time = significant(motion.error_steps as f64 * motion.dt, 6);
    let verdict = match resolves(motion) {
        true => "resolves the motion: halved steps reduce errors as predicted.",
        false if system.smooth => "does not resolve the motion.",
        false => "has no order: its forces have kinks or jumps.",
    };
    format!("{step} {verdict} Errors are those after {time} s.")
}

/// Whether the state stays finite and its errors are those of small steps.
fn resolves(motion: &EquationMotion) -> bool {
    let small = motion.errors.iter().all(|state| motion.is_resolved(state.reduction));
    small && motion.diverged_at_step.is_none()
}

fn append_errors(motion: &EquationMotion, summary: &mut Summary) {
    let rows: Vec<Vec<String>> = motion
        .errors
        .iter()
        .take(MOST)
        .map(|state| {
            let name = match state.unit.as_str() {
                "" => state.name.clone(),
                unit => format!("{} ({unit})", state.name),
            };
            vec![
                name,
                significant(state.value, 6),
                significant(state.error, 2),
                ratio(state.reduction),
                predicted(motion),
                resolved(motion, state.reduction).to_owned(),
            ]
        })
        .collect();
    let heads = [
        words("state"),
        numbers("value"),
        numbers("error"),
        numbers("halved steps reduce by"),
        numbers("predicted"),
        words(""),
    ];
    summary.blank();
    summary.table(&heads, &rows);
    summary.rest(motion.errors.len() - rows.len());
}

/// Distance of a reduction from 1 below which the steps have no part in a change of the energy.
const OWN: f64 = 0.02;

fn append_energy(motion: &EquationMotion, summary: &mut Summary) {
    let Some(energy) = &motion.energy else {
        return summary.row("energy", "the file has none, so its drift is not known");
    };
    let part = match energy.start {
        0.0 => String::new(),
        start => format!(", {} of the start", significant(energy.largest / start.abs(), 3)),
    };
    let largest = format!("{} {}", significant(energy.largest, 3), energy.unit);
    if energy.reduction.is_some_and(|reduction| (reduction - 1.0).abs() < OWN) {
        let change = largest.trim_end();
        return summary.row(
            "energy",
            &format!("changes by at most {change}{part}, over {} steps, as much as in halved steps: the system itself changes it, or the steps are far too long", energy.steps),
        );
    }
    let shown = format!(
        "changes by at most {}{part}, over {} steps; halved steps reduce this by {} ({} predicted) {}",
        largest.trim_end(),
        energy.steps,
        ratio(energy.reduction),
        predicted(motion),
        resolved(motion, energy.reduction)
    );
    summary.row("energy", shown.trim_end());
}

fn ratio(reduction: Option<f64>) -> String {
    reduction.map_or_else(|| "-".to_owned(), |x| significant(x, 4))
}

fn predicted(motion: &EquationMotion) -> String {
    motion.predicted_reduction.map_or_else(|| "-".to_owned(), |least| format!("{least:.0} or more"))
}

fn resolved(motion: &EquationMotion, reduction: Option<f64>) -> &'static str {
    if motion.is_resolved(reduction) { "" } else { "not resolved" }
}
