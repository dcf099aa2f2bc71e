//! Summaries in sentences.

use libration_report::notation::{cut_off, plural};
use libration_report::verdict::Outcome;

use super::advice::{Advice, LoopAdvice, ToleranceAnswer};
use super::budget::Budget;
use super::combined_effect::CombinedEffect;
use super::control::Control;
use super::imperfection::Imperfection;
use super::limit_text::rounded_up;
use super::loop_simulation::simulated_horizon;
use super::loops::{Loop, PlantModel};
use super::motion::four_digits;
use super::request::{Measure, Request, Tolerance};
use super::stability_window::StabilityWindow;
use super::used_share::share_in_percent;

/// The advised integrator in a sentence.
pub(super) fn describe_integrator(advice: &Advice, request: &Request) -> String {
    let Tolerance { of, most } = request.tolerance;
    // A loop is simulated for a period or more, and a limited number of them; its cost is stationary.
    let horizon = match &request.control {
        Some(control) => simulated_horizon(request.horizon, control.period),
        None => request.horizon,
    };
    let over = match of {
        Measure::Cost => String::new(),
        _ => format!(" over {horizon} s"),
    };
    let count = advice.integrators.len();
    let (range, not_tried) = advice.search.as_ref().map_or_else(Default::default, |search| {
        let [shortest, longest] = search.steps;
        (
            format!(", in steps of {} to {} s,", number(longest), number(shortest)),
            format!(" Not tried: {}.", search.not_tried.join("; ")),
        )
    });
    match advice.chosen() {
        None => {
            let steps = advice.tried_down_to.map_or_else(String::new, |shortest| {
                format!(" with steps of {shortest:.4e} s or more, and shorter ones were not tried")
            });
            let tried = plural(count, "integrator");
            let range = if steps.is_empty() { &range } else { "" };
            let range = range.trim_end_matches(',');
            format!(
                "No integrator keeps the {} below {most:e}{over}{steps}; tried were {tried}{range}.{not_tried}",
                of.title()
            )
        }
        Some((choice, dt)) if advice.verdict.outcome == Outcome::Unknown => format!(
            "Whether {} in steps of {:.4e} s keeps the {} below {most:e}{over} is not known: {}.{not_tried}",
            choice.integrator,
            cut_off(dt, 5),
            of.title(),
            advice.verdict.evidence
        ),
        Some((choice, dt)) => {
            let float = advice.float().map_or("no float type", |float| float.float);
            format!(
                "{} in steps of {:.4e} s, in {float}: the cheapest of {} that were tried{range} to keep the {} below {most:e}{over}.{not_tried}",
                choice.integrator,
                cut_off(dt, 5),
                plural(count, "integrator"),
                of.title()
            )
        }
    }
}

/// A step of a search with two digits, as in the other numbers of an answer.
fn number(dt: f64) -> String {
    format!("{:?}", format!("{dt:.1e}").parse().unwrap_or(dt))
}

/// The stability and cost of a loop in a few sentences.
pub(super) fn describe_loop(looped: &LoopAdvice, tolerance: &ToleranceAnswer) -> String {
    let CombinedEffect { growth, margin, margin_tried_up_to, cost_increase, .. } = looped.combined;
    if growth >= 0.0 {
        let remedies = looped.remedies.as_ref();
        return format!(
            "The loop is unstable with the stated imperfections: its second moments grow by {} % per period. {}",
            percent(growth.exp_m1()),
            remedies.map_or_else(String::new, |remedies| remedies.sentence(looped.gain_units))
        );
    }
    let regained = looped.budgets.iter().find_map(|budget| Some((budget, budget.regained?)));
    let mut text = match (margin, margin_tried_up_to) {
        _ if looped.combined.is_contradicted() => {
            "The simulation contradicts the theory of the loop: see the warnings.".to_owned()
        }
        _ if looped.exceeds_tolerated_cost(tolerance) => {
            "The loop is stable with the stated imperfections, but its cost exceeds the tolerance."
                .to_owned()
        }
        _ if let Some((budget, window)) = regained => describe_window(budget, window),
        (Some(margin), _) => {
            format!(
                "The loop is stable with the stated imperfections, also if all of them are {} times as large.",
                cut_off(margin, 4)
            )
        }
        (None, Some(tried)) => format!(
            "The loop is stable with the stated imperfections, also if all of them are at least {} times as large, the most that was tried.",
            cut_off(tried, 4)
        ),
        (None, None) => "The loop is stable. The request states no imperfections.".to_owned(),
    };
    if let Some(failing) = &looped.fails_first {
        text += &format!(
            " {} fails first, with {} of its budget used; {}.",
            capitalise(noun(failing.kind)),
            share_in_percent(failing.used),
            failing.how
        );
    }
    if let Some(increase) = cost_increase {
        let tolerated = match looped.exceeds_tolerated_cost(tolerance) {
            true => format!(", more than the tolerance of {} %", percent(tolerance.most)),
            false => String::new(),
        };
        text += &format!(" Its cost is {}{tolerated}.", beside_ideal(increase));
    }
    text
}

/// A relative increase of the cost in words.
pub(super) fn beside_ideal(increase: f64) -> String {
    let side = if increase < 0.0 { "below" } else { "above" };
    format!("{} % {side} that of the ideal loop", percent(increase.abs()))
}

/// The imperfection as the subject of a sentence: one thing, of which there is more or less.
pub(super) fn noun(kind: Imperfection) -> &'static str {
    match kind {
        Imperfection::Loss => "loss of commands",
        Imperfection::Skew => "clock error",
        kind => kind.name(),
    }
}

/// The words for a limit of lost commands that was not found.
pub(super) const ANY_PROBABILITY: &str = "any below 1";

/// Whether all probabilities below 1 were tried.
pub(super) fn is_any_probability(kind: Imperfection, tried_up_to: f64) -> bool {
    kind == Imperfection::Loss && 1.0 - tried_up_to < 1e-6
}

impl Budget {
    /// A limit in words: the size, or the largest tried one.
    pub fn limit_in_words(&self, limit: Option<f64>) -> String {
        match limit {
            None if is_any_probability(self.kind, self.tried_up_to) => ANY_PROBABILITY.to_owned(),
            limit => self.limit(limit),
        }
    }
}

/// A share in percent with significant digits.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match four_digits(percent) {
        0.0 => "0".to_owned(),
        small if small < 0.01 => format!("{percent:.2e}"),
        other => format!("{other}"),
    }
}

/// A loop that is stable only in a separate window, in words.
pub(super) fn describe_window(budget: &Budget, window: StabilityWindow) -> String {
    let (kind, unit, end) = (noun(budget.kind), budget.unit, window.in_words());
    let limit = rounded_up(budget.stable_up_to.unwrap_or(0.0));
    format!(
        "The loop is stable with the stated imperfections, but only in a separate stability window: {kind} alone is stable {end} {unit}, \
         and unstable below that from {limit} {unit} on. Do not rely on it: less {kind} destabilises the loop, and so does more."
    )
}

pub(super) fn capitalise(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The warnings about a loop.
pub(super) fn loop_warnings<M: PlantModel>(
    one: &Loop<M>,
    combined: &CombinedEffect,
) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(returns) = &combined.region_of_attraction {
        let [back, all] = returns.returned;
        if back < all {
            warnings.push(format!(
                "the simulation contradicts the linearisation: of {all} starts at a distance of {} from the operating point only {back} \
                 return; all return from up to {}",
                returns.deviation,
                cut_off(returns.up_to, 4)
            ));
        }
    }
    if let Some(simulated) = &combined.simulated {
        if !simulated.agrees() {
            warnings.push(format!(
                "the simulation contradicts the theory: the cost is {:.5e} ± {:.1e}, predicted {:.5e}",
                simulated.cost, simulated.error, simulated.predicted
            ));
        } else if simulated.outbursts {
            warnings.push(
                "rare outbursts dominate the cost: a simulation has too few of them, and a typical run costs less"
                    .into(),
            );
        }
    } else if combined.growth < 0.0 {
        let why = match combined.is_slow() {
            true => "it decays too slowly",
            false => "its latency is too long for losses",
        };
        warnings.push(format!(
            "the loop was not simulated because {why}: the results follow from theory alone"
        ));
    }
    let Control { period, .. } = one.control;
    let turn = (2.0 * one.plant().energy().position).sqrt() * period;
    if turn > 1.0 {
        warnings.push(format!(
            "the plant turns by {turn:.2} rad per period: the loop samples it sparsely"
        ));
    }
    if let Some(record) = &one.control.record {
        let gaps = record.iter().filter(|step| **step * (1.0 + one.control.skew) > 1.5).count();
        let repeats = record.iter().filter(|step| **step == 0.0).count();
        if gaps + repeats > 0 {
            warnings.push(format!(
                "of the {} time stamps, {gaps} follow a gap of more than 1.5 periods and {repeats} repeat; they are replayed unchanged",
                record.len() + 1
            ));
        }
        let skew = one.control.skew;
        if skew.abs() > 1e-3 {
            warnings.push(format!(
                "the mean interval of the time stamps differs from the period by {:.3} %: counted as skew",
                100.0 * skew
            ));
        }
    }
    warnings
}
