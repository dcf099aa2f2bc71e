//! The verdict on an identification.

use libration_report::notation::{number, plural};
use libration_report::{Outcome, Verdict};

use crate::dependence::Dependence;
use crate::identification::Identification;
use crate::residuals::CONTRADICTION;
use crate::summary::seconds;
use crate::warnings::{Context, is_controller, other_dead_times, other_models};

/// Fewest responses behind the first change of a command that tell a form of response from others.
const FEWEST_FOLLOWERS: usize = 10;

/// Excess kurtosis of residuals from which the likelihood of normal noise says little: that of Student's law with five degrees of freedom.
const HEAVY: f64 = 6.0;

/// Part of the range of a command that a change in one sample is at least, if it is a step: a smooth one that ten samples follow has less.
const STEP: f64 = 0.1;

/// The responses behind the first change of the command, after the dead time.
fn followers(context: &Context<'_>) -> usize {
    let recording = context.recording;
    let changes = recording.commands.windows(2).zip(&recording.command_times[1..]);
    let first = changes.filter(|(pair, _)| pair[0] != pair[1]).map(|(_, time)| *time).next();
    let since = first.unwrap_or(f64::INFINITY) + context.estimate.point.shape[0];
    recording.response_times.iter().filter(|&&time| time >= since).count()
}

/// Whether no change of a command is a step, which alone tells a dead time from a lag.
fn is_smooth(commands: &[f64]) -> bool {
    let low = commands.iter().copied().fold(f64::INFINITY, f64::min);
    let high = commands.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    commands.windows(2).all(|pair| (pair[1] - pair[0]).abs() < STEP * (high - low))
}

/// The verdict, with its evidence and what was not examined.
pub(crate) fn verdict(
    found: &Identification,
    dependence: &Dependence,
    context: &Context<'_>,
    not_examined: Vec<String>,
) -> Verdict {
    let judged = judged(found, dependence, context);
    not_examined.into_iter().fold(judged, Verdict::without)
}

fn judged(found: &Identification, dependence: &Dependence, context: &Context<'_>) -> Verdict {
    match dependence {
        Dependence::Undecided(reason) => return Verdict::unknown(reason),
        Dependence::Excluded(share) => {
            return Verdict::new(
                Outcome::Fault,
                format!(
                    "this command explains at most {} % of the variance of the response: nearly all of it comes from elsewhere",
                    number(100.0 * share, 2)
                ),
            );
        }
        Dependence::Shown => {}
    }
    let tests = &found.residuals;
    let probabilities = format!(
        "independent p = {}, of earlier commands p = {}",
        number(tests.whiteness, 2),
        number(tests.command, 2)
    );
    if found.contradicts_model() {
        let what = [vec![String::new()], found.linearity.contradictions()].concat().join("; ");
        return Verdict::new(
            Outcome::Fault,
            format!("the residuals contradict the model ({probabilities}){what}"),
        );
    }
    if let Some(lead) = context.lead {
        return Verdict::new(
            Outcome::Fault,
            format!("the response leads the command by {}", seconds(lead)),
        );
    }
    if found.is_contradicted {
        return Verdict::unknown(format!(
            "{} seem to be missing from the log",
            plural(context.recording.missing_commands(), "command")
        ));
    }
    if !found.other_dead_times.is_empty() {
        return Verdict::unknown(other_dead_times(found, context.recording));
    }
    if is_controller(context.recording) {
        return Verdict::unknown("the command is a function of the response");
    }
    let followers = followers(context);
    if followers < FEWEST_FOLLOWERS {
        return Verdict::unknown(format!(
            "only {} the first change of the command after the dead time",
            if followers == 1 {
                "one response follows".to_owned()
            } else {
                format!("{followers} responses follow")
            }
        ));
    }
    let model = &context.estimate.model;
    if model.known[0].is_none() && context.estimate.point.shape[0] > 0.98 * model.longest {
        return Verdict::unknown(format!(
            "the dead time is at the largest one tried, {}",
            seconds(model.longest)
        ));
    }
    if found.allows_any_delay() {
        return Verdict::unknown(
            "the commands do not determine the dead time: no large one is excluded",
        );
    }
    if let Some(other) = other_models(found).filter(|_| is_smooth(&context.recording.commands)) {
        return Verdict::unknown(format!("the command has no step, and {other}"));
    }
    let tests = &found.residuals;
    if tests.excess_kurtosis > HEAVY && tests.normality < CONTRADICTION {
        return Verdict::unknown(format!(
            "single residuals are far larger than the others (excess kurtosis {}): the model does not explain these responses",
            number(tests.excess_kurtosis, 2)
        ));
    }
    Verdict::new(
        Outcome::NoFault,
        format!(
            "the residuals do not contradict the model at p = {CONTRADICTION} ({probabilities})"
        ),
    )
}
