//! A comparison of integrators.

use libration_analyze::comparison::{ComparedIntegrator, Comparison};

use super::super::digits::{limit, significant};
use super::super::repeat_command::{SYSTEM, of_subcommand, with_option};
use super::{Summary, numbers, words};

/// Largest number of integrators.
const MOST: usize = 8;

/// Returns a screen of a comparison with this verdict and these notes.
pub(crate) fn of_comparison(comparison: &Comparison, verdict: &str, notes: &[String]) -> String {
    let mut summary = Summary::new(verdict);
    for note in notes {
        summary.sentence(note);
    }
    let is_cheap = |one: &&ComparedIntegrator| one.evaluations.is_some();
    let cheap: Vec<&ComparedIntegrator> = comparison.integrators.iter().filter(is_cheap).collect();
    let number = |x: Option<f64>, digits| x.map_or("-".to_owned(), |x| significant(x, digits));
    let whole = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.0}"));
    let row = |one: &&ComparedIntegrator| {
        vec![
            one.integrator.to_owned(),
            one.order.to_string(),
            one.dt.map_or_else(|| "-".to_owned(), |dt| limit(dt, 4)),
            whole(one.evaluations),
            whole(one.predicted_evaluations),
            number(one.error, 3),
            number(one.energy_error, 3),
        ]
    };
    let rows: Vec<Vec<String>> = cheap.iter().take(MOST).map(row).collect();
    if !rows.is_empty() {
        let heads = [
            words("integrator"),
            numbers("order"),
            numbers("dt (s)"),
            numbers("evaluations"),
            numbers("predicted"),
            numbers("error"),
            numbers("energy error"),
        ];
        summary.blank();
        summary.table(&heads, &rows);
    }
    if let Some((best, dt)) = cheap.first().and_then(|best| Some((best, best.dt?))) {
        let steps = format!("{:.0}", comparison.horizon / dt);
        let more = ["--integrator", best.integrator, "--dt", &dt.to_string(), "--steps", &steps];
        summary.command("Take these steps", &of_subcommand("simulate", &SYSTEM, &more));
    } else {
        let shorter = significant(0.25 * comparison.horizon, 4);
        summary.command("Compare on less time", &with_option("--horizon", &shorter));
    }
    let more = match cheap.len() > rows.len() {
        true => "more integrators, their stages",
        false => "the stages of integrators",
    };
    summary.finish(&format!("{more}, and how errors are measured and predicted"))
}
