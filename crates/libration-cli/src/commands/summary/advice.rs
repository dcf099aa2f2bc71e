//! Advice on a simulation, or on a loop around a system of the catalogue.

use libration_advise::{Advice, LoopAdvice, Measure};

use super::super::digits::{limit, short, significant};
use super::super::repeat_command::{with_joined_option, with_option};
use super::loop_limits::{
    append_limits, append_share, append_simulated, change, change_without, cost,
};
use super::{Summary, map_command, numbers, words};
use crate::args::AdviseArgs;

/// Largest number of integrators.
const MOST: usize = 5;

/// Error of a motion from which nothing is left of it.
const USEFUL: f64 = 0.1;

/// Returns a screen of advice.
pub(crate) fn of_advice(advice: &Advice, args: &AdviseArgs) -> String {
    let mut summary = Summary::new(&advice.answer);
    summary.warnings(&advice.warnings);
    match &advice.looped {
        Some(looped) => append_loop(looped, &mut summary),
        None => append_integrators(advice, &mut summary),
    }
    if let Some((purpose, command)) = next(advice, args) {
        summary.command(purpose, &command);
    }
    summary.finish(match advice.looped {
        Some(_) => {
            "the controller, a command for each number, all integrators, float types and speed"
        }
        None => "all integrators, the next longer steps, commands of the float types and speed",
    })
}

fn append_loop(looped: &LoopAdvice, summary: &mut Summary) {
    if !looped.budgets.is_empty() {
        append_limits(&looped.budgets, summary);
    }
    summary.blank();
    let combined = &looped.combined;
    if looped.held_command != 0.0 {
        let (command, unit) = (looped.command, looped.command_unit);
        let held = significant(looped.held_command, 5);
        summary.row("operating point", &format!("{command} of {held} {unit}"));
    }
    match looped.budgets.is_empty() && !looped.is_in_window() {
        true => summary
            .row("second moments", &(change_without(combined.growth) + " without imperfections")),
        false => summary.row("second moments", &change(combined.growth)),
    }
    if combined.growth < 0.0 {
        summary.row("cost", &cost(combined.cost, combined.ideal_cost));
    }
    append_share(combined.margin, summary);
    append_simulated(combined.simulated.as_ref(), "at samples, without commands", summary);
    if let Some(r) = &combined.region_of_attraction {
        let [back, all] = r.returned;
        let up_to = match r.up_to < r.tried_up_to {
            true => limit(r.up_to, 4),
            false => format!("{}, the largest tried", limit(r.up_to, 4)),
        };
        let from = r.deviation;
        let shown =
            format!("{back} of {all} loops from {from}; all from up to {up_to} (simulated)");
        summary.row("return", &shown);
    }
}

fn append_integrators(advice: &Advice, summary: &mut Summary) {
    let number = |x: Option<f64>| x.map_or_else(|| "none".to_owned(), |x| significant(x, 4));
    let error = |lost: f64| match lost.is_finite() {
        true => significant(lost, 3),
        false => "above tolerance".to_owned(),
    };
    let rows: Vec<Vec<String>> = advice
        .integrators
        .iter()
        .take(MOST)
        .map(|choice| {
            let longest = match (choice.dt, choice.tried_down_to) {
                (Some(dt), _) => limit(dt, 4),
                (None, Some(shortest)) => format!("none to {}", significant(shortest, 2)),
                (None, None) => "none".to_owned(),
            };
            vec![
                choice.integrator.to_owned(),
                longest,
                error(choice.lost),
                number(choice.evaluations),
            ]
        })
        .collect();
    let heads = [
        words("integrator"),
        numbers("largest dt (s)"),
        numbers("error"),
        numbers("force evaluations/s"),
    ];
    summary.blank();
    summary.table(&heads, &rows);
    summary.rest(advice.integrators.len() - rows.len());
    if !advice.floats.is_empty() {
        summary.blank();
    }
    for float in &advice.floats {
        let meets = if float.meets { "within" } else { "above" };
        let error = significant(float.lost, 3);
        let shown = format!("error {error} of the {}, {meets} the tolerance (simulated)", float.of);
        summary.row(&format!("in {}", float.float), &shown);
    }
}

/// The recommended command and its purpose.
fn next(advice: &Advice, args: &AdviseArgs) -> Option<(&'static str, String)> {
    match (&advice.command, &advice.looped) {
        (Some(command), None) => return Some(("Take these steps", command.clone())),
        // A loop in a stability window holds without an advised step.
        (_, Some(_)) if advice.holds() => return map_command(args),
        _ => {}
    }
    let remedies = advice.looped.as_ref().and_then(|looped| looped.remedies.as_ref());
    if let Some(remedies) = remedies {
        let gains = remedies.opposite_gains.or(remedies.gains);
        let gains = gains.filter(|_| args.config.is_none());
        return match (gains, remedies.latency) {
            (Some([position, velocity]), _) => {
                let gains = format!("{},{}", short(position), short(velocity));
                Some(("Confirm these gains", with_joined_option("--feedback", &gains)))
            }
            (None, Some(latency)) => {
                // Below it: at the limit itself the loop does not decay.
                Some(("Take a shorter latency", with_option("--latency", &limit(0.9 * latency, 2))))
            }
            (None, None) => None,
        };
    }
    if let Some(looped) = advice.looped.as_ref().filter(|_| advice.chosen().is_some()) {
        let rise = looped.combined.cost_increase.filter(|rise| *rise > advice.tolerance.most)?;
        let cost = format!("cost={}", significant(1.05 * rise, 2));
        let is_asked = advice.tolerance.of == Measure::Cost.name() && args.config.is_none();
        return is_asked.then(|| ("Tolerate this cost", with_option("--tolerance", &cost)));
    }
    // The smallest error that was found, rounded up.
    let least = advice.integrators.iter().map(|choice| choice.lost).fold(f64::INFINITY, f64::min);
    let error = format!("{}={}", advice.tolerance.of, significant(1.1 * least, 2));
    let shorter = significant(0.25 * advice.horizon, 4);
    match args.config {
        Some(_) => None,
        None if least < USEFUL => {
            Some(("Allow the smallest error found", with_option("--tolerance", &error)))
        }
        None => Some(("Follow the motion for less time", with_option("--horizon", &shorter))),
    }
}
