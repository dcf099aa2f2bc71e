//! The verdict on an identification.

use libration_report::notation::{number, plural};
use libration_report::{Outcome, Verdict};

use crate::dependence::Dependence;
use crate::identification::Identification;
use crate::residuals::CONTRADICTION;
use crate::summary::seconds;
use crate::warnings::{Context, is_controller};

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
                    "the response does not depend on this command, which explains at most {} % of its variance",
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
    if tests.contradict() {
        return Verdict::new(
            Outcome::Fault,
            format!("the residuals contradict the model ({probabilities})"),
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
    if is_controller(context.recording) {
        return Verdict::unknown("the command is a function of the response");
    }
    let model = &context.estimate.model;
    if model.known[0].is_none() && context.estimate.point.shape[0] > 0.98 * model.longest {
        return Verdict::unknown(format!(
            "the dead time is at the largest one tried, {}",
            seconds(model.longest)
        ));
    }
    Verdict::new(
        Outcome::NoFault,
        format!("the residuals do not contradict the model at p = {CONTRADICTION} ({probabilities})"),
    )
}
