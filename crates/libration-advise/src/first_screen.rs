//! The first screen of a page about a loop: its numbers, what is used of its limits, and what to do.

use libration_report::notation::{cut_off, number};
use libration_report::page::{Bar, Highlight};
use libration_report::verdict::Outcome;

use super::advice::LoopAdvice;
use super::budget::Budget;
use super::combined_effect::SimulatedCost;
use super::imperfection::Imperfection;
use super::stabilising_changes::StabilisingChanges;

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
        let value = |x: f64| number(cut(x), 4) + unit;
        let stable = own.stable_up_to.map_or_else(String::new, value);
        let (name, stated) = (own.kind.name(), number(own.stated, 4));
        match own.tolerated_up_to.flatten() {
            Some(tolerated) => Highlight {
                value: value(tolerated),
                text: format!(
                    "{name} up to which the cost is tolerated; stable up to {stable}; stated {stated}{unit}"
                ),
            },
            None => Highlight {
                text: format!("{name} up to which the loop is stable; stated {stated}{unit}"),
                value: stable,
            },
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

/// The verdict of a page in its title; `is_in_window` if less of an imperfection makes the loop unstable.
pub(super) fn title(outcome: Outcome, is_in_window: bool) -> &'static str {
    match outcome {
        Outcome::Stable if is_in_window => "The loop is stable, but only in a stability window",
        Outcome::Unstable => "The loop is unstable",
        Outcome::Exceeds => "The loop is stable, but its cost exceeds the tolerance",
        Outcome::Stable => "The loop is stable",
        _ => "It is unknown whether the loop is stable",
    }
}

/// What to do about a loop around a system of the catalogue; `is_too_costly` if its cost exceeds the tolerance.
pub(super) fn actions(looped: &LoopAdvice, is_too_costly: bool) -> Vec<String> {
    if let Some(remedies) = &looped.remedies {
        return change(remedies, looped.gain_units).into_iter().collect();
    }
    let reduce = is_too_costly.then(|| reduce(looped.combined.margin)).flatten();
    reduce.into_iter().chain(measure(&looped.budgets)).collect()
}

/// What to do about an unstable loop; none if no change of gains or latency stabilises it.
pub(super) fn change(remedies: &StabilisingChanges, gain_units: [&str; 2]) -> Option<String> {
    let all = remedies.changes(gain_units);
    let changes = all.join(", or ");
    let caveat = remedies.caveat().replace(" it has", " the loop has");
    (!all.is_empty())
        .then(|| format!("Take {changes}{caveat}. Repeat the command with the changed value."))
}

/// What to do about a cost above its tolerance; none if not even smaller imperfections are known to meet it.
pub(super) fn reduce(margin: Option<f64>) -> Option<String> {
    margin.filter(|share| (0.0..1.0).contains(share)).map(|share| {
        format!(
            "Reduce all imperfections to at most {} times their size, with which the cost meets the tolerance.",
            number(cut_off(share, 3), 3)
        )
    })
}

/// A limit with four digits, not beyond itself.
pub(super) fn cut(limit: f64) -> f64 {
    cut_off(limit, 4)
}
