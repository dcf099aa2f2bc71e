//! The first screen of a page about a loop: its numbers, what is used of its limits, and what to do.

use libration_report::notation::{cut_off, number};
use libration_report::page::{Bar, Highlight};

use super::advice::LoopAdvice;
use super::budget::Budget;
use super::combined_effect::SimulatedCost;
use super::imperfection::Imperfection;

/// The limits of the stated imperfections, and of latency, most used first.
pub(super) fn budget_numbers(budgets: &[Budget]) -> Vec<Highlight> {
    let mut shown: Vec<&Budget> = budgets
        .iter()
        .filter(|own| own.stated != 0.0 || own.kind == Imperfection::Latency)
        .filter(|own| own.stable_up_to.is_some())
        .collect();
    shown.sort_by(|a, b| b.used.unwrap_or(0.0).total_cmp(&a.used.unwrap_or(0.0)));
    let number = |own: &Budget| {
        let unit = if own.unit == "s" { " s" } else { "" };
        Highlight {
            value: own.stable_up_to.map_or_else(String::new, |x| number(cut(x), 4) + unit),
            text: format!(
                "{} up to which the loop is stable; stated {}{unit}",
                own.kind.name(),
                number(own.stated, 4)
            ),
        }
    };
    shown.into_iter().map(number).collect()
}

/// The simulated cost, beside its prediction.
pub(super) fn simulated_cost(own: &SimulatedCost) -> Highlight {
    Highlight {
        value: number(own.cost, 4),
        text: format!(
            "simulated cost, ± {}; predicted {}",
            number(own.error, 2),
            number(own.predicted, 4)
        ),
    }
}

/// The used parts of the limits of what is stated, and of the latency.
pub(super) fn budget_bars(budgets: &[Budget]) -> Vec<Bar> {
    let is_stated = |own: &&Budget| own.stated != 0.0 || own.kind == Imperfection::Latency;
    let bar = |own: &Budget| {
        let limit = own.tolerated_up_to.flatten().or(own.stable_up_to);
        let unit = if own.unit == "s" { " s" } else { "" };
        let stated = number(own.stated, 3);
        Some(match (limit, own.used) {
            (Some(limit), Some(used)) => Bar {
                name: own.name(),
                part: used,
                text: format!("{stated} of {}{unit}", number(cut(limit), 4)),
            },
            (None, _) if own.tried_up_to > 0.0 => Bar {
                name: own.name(),
                part: 0.0,
                text: format!("{stated}{unit}; no limit up to {}", number(own.tried_up_to, 3)),
            },
            _ => return None,
        })
    };
    budgets.iter().filter(is_stated).filter_map(bar).collect()
}

/// What to do about a stable loop: to measure what limits it most. None if nothing has a limit.
pub(super) fn measure(budgets: &[Budget]) -> Option<String> {
    let tightest = budgets
        .iter()
        .filter(|own| own.kind == Imperfection::Latency && own.regained.is_none())
        .find_map(|own| own.tolerated_up_to.flatten().or(own.stable_up_to))?;
    Some(format!(
        "Measure the latency of the real loop, which alone must stay below {} s: `libration clock LOG --topic … --against …`.",
        number(cut(tightest), 4)
    ))
}

/// What to do about a loop around a system of the catalogue.
pub(super) fn actions(looped: &LoopAdvice) -> Vec<String> {
    let latency = looped.remedies.as_ref().and_then(|remedies| remedies.latency);
    match (looped.combined.growth < 0.0, latency) {
        (true, _) => measure(&looped.budgets).into_iter().collect(),
        (false, Some(latency)) => vec![format!(
            "Reduce the latency to at most {} s, or change the gains as above, and repeat the command with the changed value.",
            number(cut(latency), 4)
        )],
        (false, None) => Vec::new(),
    }
}

/// A limit with four digits, not beyond itself.
pub(super) fn cut(limit: f64) -> f64 {
    cut_off(limit, 4)
}
