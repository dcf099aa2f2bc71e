//! `libration analyze --compare`.

use std::fmt::Write as _;

use libration_analyze::comparison::{
    ComparedIntegrator, Comparison, ComparisonError, ComparisonRequest, MOST_OF_BEST, compare,
};
use libration_report::notation::plural;
use libration_report::verdict::{GOOD, exit_code};
use libration_work::Work;

use super::digits::limit;
use super::{equation_file, summary};
use crate::args::AnalyzeArgs;
use crate::error::Failure;
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Integrators in the text; JSON has all of them.
const SHOWN: usize = 20;

/// Prints the comparison as text or as JSON.
pub(super) fn run(args: &AnalyzeArgs) -> Result<(), Failure> {
    let (Some(system), Some(horizon), Some(tolerance)) =
        (&args.system, args.horizon, args.tolerance)
    else {
        return Err(Failure::usage("--compare requires --system, --tolerance and --horizon"));
    };
    let system = equation_file::any_system(system)?;
    let request = ComparisonRequest { system, horizon, tolerance };
    let reporter = Reporter::new(args.json);
    let found = interrupt::compute(|stop| compare(&Work::new(&reporter, stop), &request));
    reporter.clear();
    let found = found.map_err(|error| match error {
        ComparisonError::Interrupted => Failure::Interrupted(error.to_string()),
        error => Failure::usage(error),
    })?;
    let text = match (args.json, args.verbose) {
        (true, _) => serde_json::to_string_pretty(&found).map_err(Failure::run)? + "\n",
        (false, true) => describe(&found),
        (false, false) => summary::of_comparison(&found, &verdict(&found), &notes(&found)),
    };
    terminal::print(&text)?;
    match exit_code([&found.verdict]) {
        GOOD => Ok(()),
        _ => Err(Failure::Disagreement),
    }
}

/// The cheapest integrator in a sentence.
fn verdict(comparison: &Comparison) -> String {
    let Comparison { system, horizon, tolerance, integrators, .. } = comparison;
    match integrators.iter().find(|one| one.evaluations.is_some()) {
        Some(best) if !comparison.verdict.is_good() => format!(
            "Whether {} in steps of {} s keeps an error of {tolerance:e} over {horizon} s of {system} is not known: {}.",
            best.integrator,
            step(best.dt),
            comparison.verdict.evidence,
        ),
        Some(best) => format!(
            "{}: the cheapest of {} that were tried for an error of {tolerance:e} of the largest size of each state over {horizon} s of {system}, with steps of {} s",
            best.integrator,
            plural(integrators.len(), "integrator"),
            step(best.dt),
        ),
        None => format!(
            "Of {} that were tried none meets an error of {tolerance:e} over {horizon} s of {system} with up to {:.0} force evaluations; more were not tried.",
            plural(integrators.len(), "integrator"),
            comparison.most_evaluations,
        ),
    }
}

/// Restrictions of a comparison.
fn notes(comparison: &Comparison) -> Vec<String> {
    let integrators = &comparison.integrators;
    let without = integrators.iter().filter(|one| one.evaluations.is_none()).count();
    let mut notes = Vec::new();
    if without > 0 && without < integrators.len() {
        let verb = if without == 1 { "does" } else { "do" };
        notes.push(format!(
            "{} {verb} not meet the tolerance with up to {:.0} force evaluations, {MOST_OF_BEST} times those of the best common ones; more were not tried.",
            plural(without, "integrator"),
            comparison.most_evaluations,
        ));
    }
    notes.push(format!("Not tried: {}.", comparison.verdict.not_examined.join(", ")));
    notes.push(
        "`advise --tolerance trajectory=` judges all states together, `energy=` the energy: for the same number their steps differ.".to_owned(),
    );
    if !comparison.is_smooth {
        notes.push(
            "The forces have kinks or jumps: what acts for less than the horizon over 2048 may be missed.".to_owned(),
        );
    }
    if !comparison.is_positional {
        notes.push(
            "Splitting and Nyström methods by tables are left out: a force of this system depends on a velocity.".to_owned(),
        );
    }
    notes
}

// Writing into a string cannot fail.
fn describe(comparison: &Comparison) -> String {
    let fit: Vec<&ComparedIntegrator> =
        comparison.integrators.iter().filter(|one| one.evaluations.is_some()).collect();
    let mut text = format!("{}\n\n", verdict(comparison));
    let _ = writeln!(
        text,
        "  {:<34} {:>5} {:>6} {:>10} {:>12} {:>12} {:>10} {:>10}",
        "integrator", "order", "stages", "dt (s)", "evaluations", "predicted", "error", "energy"
    );
    for one in fit.iter().take(SHOWN) {
        let _ = writeln!(
            text,
            "  {:<34} {:>5} {:>6} {:>10} {:>12} {:>12} {:>10} {:>10}",
            one.integrator,
            one.order,
            one.stages,
            step(one.dt),
            whole(one.evaluations),
            whole(one.predicted_evaluations),
            number(one.error),
            number(one.energy_error),
        );
    }
    let more = fit.len().saturating_sub(SHOWN);
    let _ = writeln!(text);
    if more > 0 {
        let _ = writeln!(text, "{} more in --json.", plural(more, "integrator"));
    }
    for note in notes(comparison) {
        let _ = writeln!(text, "{note}");
    }
    let _ = writeln!(
        text,
        "Errors: the largest of a state after any of up to 4096 steps, and of more where the motion is fast; relative to its largest size; the reference is right to {:.0e}.",
        comparison.reference_error
    );
    text += "Predicted: from error constants and the integrator of the same order with the fewest stages.\n";
    text
}

/// A largest step, not beyond itself.
fn step(dt: Option<f64>) -> String {
    dt.map_or_else(|| "-".to_owned(), |dt| limit(dt, 4))
}

fn number(x: Option<f64>) -> String {
    x.map_or_else(
        || "-".to_owned(),
        |x| if (1e-3..1e4).contains(&x) { format!("{x:.5}") } else { format!("{x:.2e}") },
    )
}

fn whole(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), |x| format!("{x:.0}"))
}
