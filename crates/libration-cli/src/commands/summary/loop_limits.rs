//! The limits of a loop.

use libration::linear::GROWTH_ROUNDING;
use libration_advise::{Budget, SimulatedCost};

use super::super::digits::{limit, significant};
use super::{Summary, numbers, words};

/// Largest number of limits.
const MOST: usize = 5;

/// Appends the limit of each imperfection: of many those that are used most.
pub(super) fn append_limits(budgets: &[Budget], summary: &mut Summary) {
    let tolerance = budgets.iter().any(|budget| budget.tolerated_up_to.is_some());
    let mut order: Vec<&Budget> = budgets.iter().collect();
    if order.len() > MOST {
        let rank = |budget: &Budget| match used(budget) > 0.0 {
            true => used(budget),
            // What is not stated at a single input or output comes last.
            false => {
                if is_of_channel(budget) {
                    -2.0
                } else {
                    -1.0
                }
            }
        };
        order.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
        order.truncate(MOST);
    }
    let mut columns = vec![words("each alone"), numbers("stated"), numbers("stable up to")];
    if tolerance {
        columns.push(numbers("tolerated up to"));
    }
    columns.extend([numbers("used"), words("unit")]);
    let rows: Vec<Vec<String>> = order
        .iter()
        .map(|budget| {
            let mut row = vec![budget.name(), significant(budget.stated, 4)];
            row.push(limit_of(budget, budget.stable_up_to));
            if tolerance {
                row.push(
                    budget.tolerated_up_to.map_or_else(String::new, |end| limit_of(budget, end)),
                );
            }
            row.extend([budget.used_in_percent(), budget.unit.to_owned()]);
            row
        })
        .collect();
    summary.blank();
    summary.table(&columns, &rows);
    let more = budgets.len() - rows.len();
    if more > 0 {
        summary.sentence(&format!("and {more} more that are used less, or not at all"));
    }
}

/// The used part; infinite where the loop is stable with the stated size only in a separate window, or not at all.
fn used(budget: &Budget) -> f64 {
    let fails = budget.regained.is_some() || budget.stable_up_to == Some(0.0);
    if fails { f64::INFINITY } else { budget.used.unwrap_or(0.0) }
}

/// Whether a budget is that of one of several inputs or outputs.
fn is_of_channel(budget: &Budget) -> bool {
    budget.channel.as_ref().is_some_and(|channel| !channel.starts_with("all "))
}

fn limit_of(budget: &Budget, end: Option<f64>) -> String {
    end.map_or_else(|| budget.limit_in_words(None), |end| limit(end, 4))
}

/// How second moments change in a period.
pub(super) fn change(growth: f64) -> String {
    change_without(growth) + " with all imperfections"
}

/// The same without imperfections.
pub(super) fn change_without(growth: f64) -> String {
    let change = growth.exp_m1();
    let verb = if change < 0.0 { "fall" } else { "grow" };
    match growth.abs() <= GROWTH_ROUNDING {
        true => format!(
            "change by less than {} % per period, within rounding",
            significant(100.0 * GROWTH_ROUNDING, 4)
        ),
        false => format!("{verb} by {} % per period", significant(100.0 * change.abs(), 4)),
    }
}

/// Appends the part of the imperfections that the tolerance of the cost allows; nothing if it allows all of them.
pub(super) fn append_share(margin: Option<f64>, summary: &mut Summary) {
    if let Some(share) = margin.filter(|share| *share < 1.0) {
        let shown = format!("all imperfections at most {} times as large", limit(share, 3));
        summary.row("reduce to", &shown);
    }
}

/// Appends a simulated cost and its prediction, `of` samples.
pub(super) fn append_simulated(own: Option<&SimulatedCost>, of: &str, summary: &mut Summary) {
    let Some(own) = own else { return };
    let [cost, predicted] = [own.cost, own.predicted].map(|x| significant(x, 4));
    let error = significant(own.error, 2);
    let shown = format!("{cost} ± {error} of {} loops, {predicted} predicted ({of})", own.loops);
    summary.row("simulated cost", &shown);
}

/// A cost and that of the ideal loop.
pub(super) fn cost(cost: Option<f64>, ideal: f64) -> String {
    let shown = cost.map_or_else(|| "infinite".to_owned(), |cost| significant(cost, 5));
    let ideal = if ideal.is_finite() { significant(ideal, 5) } else { "infinite".to_owned() };
    format!("{shown} under noise, {ideal} without imperfections")
}
